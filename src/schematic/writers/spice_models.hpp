#pragma once

#include <string>

#include "schematic/deviations.hpp"

/// The models that netlists use, as portable subcircuits; no end of line after the last line.
namespace bodesmith::schematic {

/// `.subckt NAME p n o`: two poles, slew rate, swing, output resistance and noise by resistors and diodes only, so that every
/// simulator has it; two lines for an ideal model.
std::string opamp_subcircuit(const OpAmpModel& model, const std::string& name = "bodesmith_opamp");
/// `.subckt NAME x y z w`: W = X Y/U + Z behind one pole, limited.
std::string multiplier_subcircuit(const MultiplierModel& model, const std::string& name,
                                  const MultiplierDeviation& off = {});
/// `.subckt bodesmith_switch a o e`: one contact; DesignError as SwitchTimer::of.
std::string switch_subcircuit(const SwitchModel& model);
/// `.model bodesmith_diode`.
std::string diode_model(const DiodeModel& model);

}  // namespace bodesmith::schematic
