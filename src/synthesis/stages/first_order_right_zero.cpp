#include "lti/sections.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// A zero in the right half plane: the resistive path is inverted before the summing node, the capacitive one
/// is not.
///   n = -(Rb/Ra) in,  H(s) = (R2/R1)(Rb/Ra) (1 - s R1 C1 Ra/Rb)/(1 + s R2 C2):
/// with Ra = Rb the zero is at +1/(R1 C1) and H(inf) = -C1/C2.
class FirstOrderRightZero final : public StageForm {
 public:
  explicit FirstOrderRightZero(const Section& section)
      : pole_(-section.poles[0].real()), zero_(section.zeros[0].real()) {
    wanted_ = Biquad::from_section(negated(section));
    resistor("Ra", "in", "k");
    resistor("Rb", "k", "n");
    resistor("R1", "n", "m");
    capacitor("C1", "in", "m", {zero_}, 1.0);
    resistor("R2", "m", "out");
    capacitor("C2", "m", "out", {pole_}, 1.0 / section.gain);
    opamp("U1", "0", "k", "n");
    opamp("U2", "0", "m", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    const double ra = v[0], rb = v[1], r1 = v[2], c1 = v[3], r2 = v[4], c2 = v[5];
    return {.b0 = rb / ra * r2 / r1, .b1 = -c1 * r2, .a0 = 1.0, .a1 = r2 * c2};
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    return std::vector<double>{kInverter, kInverter, 1.0 / (zero_ * c[0]), c[0], 1.0 / (pole_ * c[1]), c[1]};
  }

  std::optional<std::vector<double>> exact_near(std::span<const double> realised) const override {
    const double both[2] = {realised[5] * std::abs(wanted_.b1 / wanted_.a1), realised[5]};
    return design(both);
  }

 private:
  static constexpr double kInverter = 20e3;
  double pole_;
  double zero_;
};

class FirstOrderRightZeroRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "first-order-right-zero"; }
  bool makes_two_poles() const override { return false; }
  int bid(const Section& section) const override { return refusal(section) ? 0 : 1; }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.size() != 1) return Refusal{"it makes one pole"};
    if (integrates(section)) return Refusal{"it makes no pole at 0"};
    if (section.zeros.empty() || section.zeros[0].real() <= 0.0)
      return Refusal{"it makes a zero in the right half plane"};
    return std::nullopt;
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    return std::make_unique<FirstOrderRightZero>(section);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, first_order_right_zero, FirstOrderRightZeroRealisation)

}  // namespace bodesmith::synthesis
