#include <cmath>

#include "lti/sections.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// The first-order form with a second capacitor C3 beside C1, for designs of one or two stages: H(inf) = -(C1
/// + C3)/C2, which E12 values alone meet only in steps of about 1.7 dB.
class FirstOrderTrimmed final : public StageForm {
 public:
  explicit FirstOrderTrimmed(const Section& section)
      : pole_(-section.poles[0].real()), zero_(-section.zeros[0].real()) {
    wanted_ = Biquad::from_section(negated(section));
    if (zero_ > 0.0) resistor("R1", "in", "m");
    capacitor("C1", "in", "m", {zero_ > 0.0 ? zero_ : pole_}, 1.0);
    capacitor("C3", "in", "m", {zero_ > 0.0 ? zero_ : pole_}, 1.0 / 8.0, 6.0);
    resistor("R2", "m", "out");
    capacitor("C2", "m", "out", {pole_}, 1.25 / section.gain, 1.5);
    opamp("U1", "0", "m", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    const std::size_t i = zero_ > 0.0 ? 1 : 0;
    const double g1 = zero_ > 0.0 ? 1.0 / v[0] : 0.0;
    return {.b0 = -g1 * v[i + 2], .b1 = -(v[i] + v[i + 1]) * v[i + 2], .a0 = 1.0, .a1 = v[i + 2] * v[i + 3]};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    std::vector<double> values;
    if (zero_ > 0.0) values.push_back(1.0 / (zero_ * (c[0] + c[1])));
    for (const double value : {c[0], c[1], 1.0 / (pole_ * c[2]), c[2]}) values.push_back(value);
    return values;
  }

  std::optional<std::vector<double>> exact_near(std::span<const double> realised) const override {
    const std::vector<double> c = capacitors(realised);
    const double sum = c[2] * std::abs(wanted_.b1 / wanted_.a1);
    const double three[3] = {c[0], sum - c[0], c[2]};
    if (!(three[1] > 0.0)) return std::nullopt;
    return design(three);
  }

 private:
  double pole_;
  double zero_;
};

class FirstOrderTrimmedRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "first-order-trimmed"; }
  bool makes_two_poles() const override { return false; }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.size() != 1) return Refusal{"it makes one pole"};
    if (section.zeros.empty()) return Refusal{"it makes a zero"};
    if (integrates(section)) return Refusal{"it makes no pole at 0"};
    if (section.zeros[0].real() > 0.0) return Refusal{"its zero cannot lie in the right half plane"};
    return std::nullopt;
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    return std::make_unique<FirstOrderTrimmed>(section);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, first_order_trimmed, FirstOrderTrimmedRealisation)

}  // namespace bodesmith::synthesis
