#pragma once

#include "base/units.hpp"
#include "fpaa/cams/switches.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::fpaa {

/// Of this chip's op-amps nothing is publicly known: an assumption that the user may set.
inline schematic::OpAmpModel default_opamp() {
  return schematic::OpAmpModel::one_pole(Hertz{20e6}, 1e5);
}

/// What is left of a stage's largest step when a phase ends: the worst of its op-amps and phases of
///   exp(-2 pi beta gain_bandwidth t) + 1/(beta gain),   beta = C_feedback/C_at_the_inverting_input,   t = T/2
/// (Gregorian and Temes, Analog MOS Integrated Circuits for Signal Processing, 1986, section 6.6), each op-amp's
/// inputs taken as settled. To that comes what the op-amps, one after the other, are behind a sine of `highest` that they
/// follow through a phase: each 1/(2 pi beta gain_bandwidth), of a sine highest/(beta gain_bandwidth).
double unsettled_share(const StageSwitches& stage, const schematic::OpAmpModel& opamp, Hertz clock,
                       Hertz highest);

}  // namespace bodesmith::fpaa
