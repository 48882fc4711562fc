#pragma once

#include "controller/behaviour.hpp"

namespace bodesmith::controller {

/// The same chain as differential equations, integrated by CVODE (stiff, restarted at every corner of the reference
/// and at every change of the switch), beside what ngspice makes of the netlist:
///   differentiator   vc' = (r - vc)/(Rs Cd),  w' = -((r - vc)/Rs + w/Rd)/Cf,  |w| <= the op-amp's swing
///   smoothing        s' = (|w| - s)/tau,  rate gain by the rectifiers' curve
///   each sum         b' = 2 pi GBW/noise gain (d_b(x) - b), the subtraction alike
/// The switch acts switch_delay_s after a corner. Multipliers and rectifiers are instantaneous.
Settled run_in_cvode(const AnalogController& controller, const tracking::Reference& reference,
                     Hertz operating, std::size_t samples = 2048);

}  // namespace bodesmith::controller
