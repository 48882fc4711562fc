#pragma once

#include "fpaa/controller/controller.hpp"

namespace bodesmith::fpaa {

/// Gives a CAM that weighs its inputs (SumDiff; GainHold, one input, inverting) the capacitors that make
/// `rate_gain` times its weights with the least error (products): its z, realised gains and late inputs
/// follow. A weight of 0 has no capacitor.
void set_weights(ControllerCam& cam, double rate_gain, int max_capacitor);

/// A SumDiff whose first weight is exactly 1: the others as near as capacitors come.
void set_weights_first_exact(ControllerCam& cam, int max_capacitor);

}  // namespace bodesmith::fpaa
