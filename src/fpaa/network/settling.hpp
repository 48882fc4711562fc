#pragma once

#include "base/units.hpp"
#include "fpaa/cams/switches.hpp"
#include "fpaa/device/mismatch.hpp"

namespace bodesmith::fpaa {

/// What is left of a stage's largest step when a phase ends, each the worst of its op-amps and phases.
struct Unsettled {
  /// exp(-t/tau), t = T/2, tau = 1/(2 pi beta gain_bandwidth) + 2 switch_s C, beta = C_feedback/C_at_the_inverting_input, C the
  /// largest capacitor there, between two switches (Gregorian and Temes, Analog MOS Integrated Circuits for Signal Processing, 1986,
  /// section 6.6); each op-amp's inputs taken as settled.
  double moving = 0.0;
  double by_gain = 0.0;  ///< 1/(beta gain)
};
Unsettled unsettled(const StageSwitches& stage, const SlowParts& parts, Hertz clock);

}  // namespace bodesmith::fpaa
