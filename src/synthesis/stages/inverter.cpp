#include <cmath>

#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
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

  std::optional<std::vector<double>> design(std::span<const double>) const override {
    // The greater of the two is kResistance unless the gain is so far from 1 that the other would be tiny.
    const double gain = std::abs(wanted_.b0);
    const double r1 = gain <= 1.0 ? kResistance : std::max(kResistance / std::sqrt(gain), 2e3);
    return std::vector<double>{r1, r1 * gain};
  }

 private:
  static constexpr double kResistance = 20e3;
};

class InverterRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "inverter"; }
  int bid(const Section& section) const override { return refusal(section) ? 0 : 1; }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (section.poles.empty()) return std::nullopt;
    return Refusal{"it makes a gain only"};
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    return std::make_unique<Inverter>(section);
  }
};

}  // namespace

BODESMITH_ENTRY(Realisation, inverter_realisation, InverterRealisation)

const StageRealisation& inverter() {
  return *inverter_realisation().stage_realisation();
}

}  // namespace bodesmith::synthesis
