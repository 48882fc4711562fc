#pragma once

#include <vector>

#include "controller/controller.hpp"
#include "multiplier_layout/bench.hpp"

namespace bodesmith::controller {

/// What one built copy has different from the description. Empty lists: nothing.
struct Deviations {
  std::vector<double> part;            ///< relative, by place in AnalogController::parts
  std::vector<double> opamp_offset_v;  ///< at the input, by place in AnalogController::opamps
  /// By place in AnalogController::multipliers.
  std::vector<multiplier_layout::MultiplierDeviation> multiplier;
  std::vector<double> reference;  ///< relative, by place in AnalogController::references
  double switch_relative = 0.0;   ///< of the contacts' resistance
  double switch_charge_c = 0.0;   ///< beside the model's, ngspice only
  double switch_delay_s = 0.0;    ///< beside the model's

  /// Every list at its length, all 0.
  static Deviations none(const AnalogController& controller);

  double value(const AnalogController& controller, int index) const {
    const auto i = static_cast<std::size_t>(index);
    return controller.parts[i].realised * (1.0 + (part.empty() ? 0.0 : part[i]));
  }
  double offset(int opamp) const {
    return opamp_offset_v.empty() ? 0.0 : opamp_offset_v[static_cast<std::size_t>(opamp)];
  }
};

}  // namespace bodesmith::controller
