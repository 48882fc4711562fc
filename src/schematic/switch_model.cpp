#include "schematic/switch_model.hpp"

#include <cmath>

#include "base/error.hpp"

namespace bodesmith::schematic {

SwitchModel SwitchModel::for_branches(std::size_t count) {
  SwitchModel out;
  if (count <= 2) return out;
  out.name = "ADG408";
  out.on_ohm = 40.0;
  out.on_delay_s = 120e-9;
  out.gap_s = 10e-9;
  out.charge_c = 20e-12;
  out.source_f = 11e-12;
  out.drain_f = 5e-12;
  return out;
}

SwitchTimer SwitchTimer::of(const SwitchModel& model) {
  if (!(model.gap_s >= 0.0) || !(model.gap_s < model.on_delay_s)) {
    throw DesignError("the switch's break-before-make gap must be at least 0 and shorter than its delay");
  }
  // exp(-on/tau) + exp(-off/tau) rises with tau from 0 to 2.
  double low = 1e-3 * model.on_delay_s, high = 10.0 * model.on_delay_s;
  for (int i = 0; i < 100; ++i) {
    const double tau = 0.5 * (low + high);
    (std::exp(-model.on_delay_s / tau) + std::exp(-model.off_delay_s() / tau) < 1.0 ? low : high) = tau;
  }
  SwitchTimer out;
  out.tau_s = 0.5 * (low + high);
  out.level = std::exp(-model.off_delay_s() / out.tau_s);
  return out;
}

}  // namespace bodesmith::schematic
