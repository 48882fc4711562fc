#pragma once

#include "base/units.hpp"
#include "fpaa/cams/switches.hpp"

namespace bodesmith::fpaa {

/// An op-amp with one pole: dV/dt = 2 pi gain_bandwidth (-v - V/gain), v at its inverting input, the other
/// input at ground. Not publicly known for this chip: assumptions that the user may set.
struct OpAmpModel {
  Hertz gain_bandwidth{20e6};
  double gain = 1e5;
};

/// What is left of a stage's largest step when a phase ends: the worst of its op-amps and phases of
///   exp(-2 pi beta gain_bandwidth t) + 1/(beta gain),   beta = C_feedback/C_at_the_inverting_input,   t = T/2
/// (Gregorian and Temes, Analog MOS Integrated Circuits for Signal Processing, 1986, section 6.6), each op-amp's
/// inputs taken as settled.
double unsettled_share(const StageSwitches& stage, const OpAmpModel& opamp, Hertz clock);

}  // namespace bodesmith::fpaa
