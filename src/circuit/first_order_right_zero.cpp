#include "circuit/forms.hpp"

namespace bodesmith::circuit {
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
    Biquad h;
    h.b0 = rb / ra * r2 / r1;
    h.b1 = -c1 * r2;
    h.a0 = 1.0;
    h.a1 = r2 * c2;
    return h;
  }

  bool gain_follows_capacitors() const override { return true; }

  bool design(std::span<const double> c, std::vector<double>& values) const override {
    values = {kInverter, kInverter, 1.0 / (zero_ * c[0]), c[0], 1.0 / (pole_ * c[1]), c[1]};
    return true;
  }

  bool exact_near(std::span<const double> realised, std::vector<double>& exact) const override {
    const double both[2] = {realised[5] * std::abs(wanted_.b1 / wanted_.a1), realised[5]};
    return design(both, exact);
  }

 private:
  static constexpr double kInverter = 20e3;
  double pole_;
  double zero_;
};

std::string refusal(const Section& section) {
  if (section.poles.size() != 1) return "it makes one pole";
  if (section.zeros.empty() || section.zeros[0].real() <= 0.0)
    return "it makes a zero in the right half plane";
  return {};
}

}  // namespace

Realization first_order_right_zero_realization() {
  return {"first-order-right-zero", "one real pole and a zero in the right half plane: two op-amps", true,
          refusal, [](const Section& section, const FormOptions&) -> std::unique_ptr<StageForm> {
            return std::make_unique<FirstOrderRightZero>(section);
          }};
}

}  // namespace bodesmith::circuit
