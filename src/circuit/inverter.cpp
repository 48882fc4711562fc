#include <cmath>

#include "circuit/forms.hpp"

namespace bodesmith::circuit {
namespace {

/// H = -R2/R1.
class Inverter final : public StageForm {
 public:
  explicit Inverter(const Section& section) {
    wanted_ = Biquad::from_section(negated(section));
    resistor("R1", "in", "m");
    resistor("R2", "m", "out");
    opamp("U1", "0", "m", "out");
  }

  Biquad transfer(std::span<const double> v) const override {
    Biquad h;
    h.b0 = -v[1] / v[0];
    return h;
  }

  bool design(std::span<const double>, std::vector<double>& values) const override {
    // The greater of the two is kResistance unless the gain is so far from 1 that the other would be tiny.
    const double gain = std::abs(wanted_.b0);
    const double r1 = gain <= 1.0 ? kResistance : std::max(kResistance / std::sqrt(gain), 2e3);
    values = {r1, r1 * gain};
    return true;
  }

 private:
  static constexpr double kResistance = 20e3;
};

std::string refusal(const Section& section) {
  return section.poles.empty() ? "" : "it makes a gain only";
}

}  // namespace

Realization inverter_realization() {
  return {"inverter", "an inverting amplifier: a gain without poles", true, refusal,
          [](const Section& section, const FormOptions&) -> std::unique_ptr<StageForm> {
            return std::make_unique<Inverter>(section);
          }};
}

}  // namespace bodesmith::circuit
