#include <algorithm>
#include <cmath>

#include "lti/sections.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
const Realisation& first_order_trimmed();

namespace {

/// R1||C1 into R2||C2 around an inverting op-amp (Sedra and Smith, first-order active RC):
///   H(s) = -(R2/R1) (1 + s R1 C1)/(1 + s R2 C2),   zero at -1/(R1 C1), pole at -1/(R2 C2), H(inf) = -C1/C2.
/// Without a zero C1 is absent; with a zero at the origin R1 is. C1 loads the stage before: Rs in series with
/// it (about the output resistance of its op-amp) keeps that one's phase margin, moves the zero to -1/((R1 +
/// Rs) C1) and adds a pole at -1/(Rs C1), far above. With a pole at the origin R2 is absent:
///   H(s) = -(1 + s R1 C1)/(s R1 C2),   without the zero the integrator -1/(s R1 C2).
/// `trimmed`: a second capacitor C3 in parallel with C1, for designs of one or two stages: H(inf) = -(C1 + C3)/C2, which E12 values
/// alone meet only in steps of about 1.7 dB.
class FirstOrder final : public StageForm {
 public:
  FirstOrder(const Section& section, const FormOptions& options, bool trimmed)
      : pole_(-section.poles[0].real()), trimmed_(trimmed) {
    wanted_ = Biquad::from_section(negated(section));
    has_zero_ = !section.zeros.empty();
    zero_ = has_zero_ ? -section.zeros[0].real() : 0.0;
    integrates_ = integrates(section);
    // Both capacitors about equal unless the gain says otherwise: H(inf) = -C1/C2.
    const double ratio = has_zero_ ? section.gain : 1.0;
    if (!has_zero_ || zero_ > 0.0) resistor("R1", "in", "m");
    isolation_ = has_zero_ && !trimmed ? options.isolation_ohm : 0.0;
    if (isolation_ > 0.0) fixed_resistor("Rs", "in", "c");
    if (has_zero_) capacitor("C1", isolation_ > 0.0 ? "c" : "in", "m", {zero_ > 0.0 ? zero_ : pole_}, 1.0);
    if (trimmed) capacitor("C3", "in", "m", {zero_ > 0.0 ? zero_ : pole_}, 1.0 / 8.0, 6.0);
    if (!integrates_) resistor("R2", "m", "out");
    // Without a zero R1 = R2/|H(0)|: C2 must leave room for the greater of the two.
    const double room = has_zero_ ? 1.0 : std::min(1.0, std::abs(wanted_.b0 / wanted_.a0));
    const double works_at = !integrates_ ? pole_ * room : has_zero_ ? zero_ : section.gain;
    capacitor("C2", "m", "out", {works_at}, (trimmed ? 1.25 : 1.0) / ratio, trimmed ? 1.5 : 0.0);
    opamp("U1", "0", "m", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    std::size_t i = 0;
    const double g1 = !has_zero_ || zero_ > 0.0 ? 1.0 / v[i++] : 0.0;
    const double rs = isolation_ > 0.0 ? v[i++] : 0.0;
    double c1 = has_zero_ ? v[i++] : 0.0;
    if (trimmed_) c1 += v[i++];
    if (integrates_) return integrator(g1, rs, c1, v[i]);
    const double r2 = v[i++];
    const double c2 = v[i];
    return {.b0 = -g1 * r2,
            .b1 = -c1 * r2 * (1.0 + g1 * rs),
            .a0 = 1.0,
            .a1 = r2 * c2 + rs * c1,
            .a2 = r2 * c2 * rs * c1};
  }

  /// Without the pole of Rs, which no choice of the other parts could make good.
  Biquad aim(std::span<const double> v) const override {
    Biquad h = transfer(v);
    h.a1 = integrates_ ? v.back() : v[v.size() - 2] * v[v.size() - 1];
    h.a2 = 0.0;
    return h;
  }

  std::optional<std::vector<double>> design(std::span<const double> c) const override {
    const double c2 = c.back();
    const double r2 = integrates_ ? 0.0 : 1.0 / (pole_ * c2);
    std::vector<double> values;
    // |H(0)| = b0/a0 = R2/R1 sets R1 where no zero does, or the slope of the integrator.
    if (!has_zero_)
      values.push_back(integrates_ ? 1.0 / (std::abs(wanted_.b0) * c2)
                                   : r2 / std::abs(wanted_.b0 / wanted_.a0));
    if (has_zero_ && zero_ > 0.0) {
      values.push_back(1.0 / (zero_ * (trimmed_ ? c[0] + c[1] : c[0])) - isolation_);
      if (!(values.back() > 0.0)) return std::nullopt;
    }
    if (isolation_ > 0.0) values.push_back(isolation_);
    values.insert(values.end(), c.begin(), c.end() - 1);
    if (!integrates_) values.push_back(r2);
    values.push_back(c2);
    return values;
  }

  std::optional<std::vector<double>> exact_near(std::span<const double> realised) const override {
    const double c2 = realised.back();
    if (!has_zero_) return design(std::span(&c2, 1));
    const double sum = c2 * std::abs(wanted_.b1 / wanted_.a1);
    // Above its zero R1 carries the signal as well as Rs and C1 do.
    if (!trimmed_) return design(std::vector{sum / (1.0 + isolation_ * zero_ * sum), c2});
    const double c1 = capacitors(realised).front();
    if (!(sum > c1)) return std::nullopt;
    return design(std::vector{c1, sum - c1, c2});
  }

 private:
  static Biquad integrator(double g1, double rs, double c1, double c2) {
    return {.b0 = -g1, .b1 = -c1 * (1.0 + g1 * rs), .a0 = 0.0, .a1 = c2, .a2 = c2 * rs * c1};
  }

  double pole_;
  double zero_ = 0.0;
  bool has_zero_ = false;
  bool integrates_ = false;
  bool trimmed_ = false;
  double isolation_ = 0.0;
};

class FirstOrderRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "first-order"; }
  bool makes_two_poles() const override { return false; }
  int bid(const Section& section) const override { return refusal(section) ? 0 : 1; }
  const StageRealisation* trimmed() const override { return first_order_trimmed().stage_realisation(); }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.size() != 1) return Refusal{"it makes one pole"};
    if (!section.zeros.empty() && section.zeros[0].real() > 0.0)
      return Refusal{"its zero cannot lie in the right half plane"};
    if (integrates(section) && !section.zeros.empty() && section.zeros[0] == 0.0)
      return Refusal{"its pole and its zero at 0 cancel"};
    return std::nullopt;
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions& options) const override {
    return std::make_unique<FirstOrder>(section, options, false);
  }
};

class FirstOrderTrimmedRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "first-order-trimmed"; }
  bool makes_two_poles() const override { return false; }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.zeros.empty()) return Refusal{"it makes a zero"};
    if (integrates(section)) return Refusal{"it makes no pole at 0"};
    return FirstOrderRealisation().refusal(section);
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions& options) const override {
    return std::make_unique<FirstOrder>(section, options, true);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, first_order, FirstOrderRealisation)

BODESMITH_ENTRY(Realisation, first_order_trimmed, FirstOrderTrimmedRealisation)

}  // namespace bodesmith::synthesis
