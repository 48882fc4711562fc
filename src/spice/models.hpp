#pragma once

#include <optional>
#include <string>

#include "multiplier_layout/bench.hpp"
#include "multiplier_layout/switch.hpp"
#include "multiplier_layout/timing.hpp"

namespace bodesmith::spice {

struct MultiplierText {
  std::string subcircuit;  ///< its name
  multiplier_layout::MultiplierModel model;
  std::optional<multiplier_layout::MultiplierDeviation> off;
};

/// `.subckt NAME x y z w`: W = X Y/U + Z behind one pole, limited. No end of line after the last line of these.
std::string multiplier_subcircuit(const MultiplierText& multiplier);
/// `.subckt bodesmith_switch a o e`: one contact; DesignError as SwitchTimer::of.
std::string switch_subcircuit(const multiplier_layout::SwitchModel& model);
/// `.model bodesmith_diode`.
std::string diode_model(const multiplier_layout::DiodeModel& model);

}  // namespace bodesmith::spice
