#pragma once

#include "base/units.hpp"
#include "fpaa/cams/switches.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::fpaa {

/// What is left of a stage's largest step when a phase ends: the worst of its op-amps and phases of
///   exp(-2 pi beta gain_bandwidth t) + 1/(beta gain),   beta = C_feedback/C_at_the_inverting_input,   t = T/2
/// (Gregorian and Temes, Analog MOS Integrated Circuits for Signal Processing, 1986, section 6.6), each op-amp's
/// inputs taken as settled.
double unsettled_share(const StageSwitches& stage, const schematic::OpAmpModel& opamp, Hertz clock);

}  // namespace bodesmith::fpaa
