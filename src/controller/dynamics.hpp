#pragma once

#include "controller/as_built.hpp"

namespace bodesmith::controller {

/// The whole netlist in time by CVODE (schematic/analysis/in_time.hpp), beside what ngspice makes of it: from rest, as many
/// repeats of the reference as the smoothing behind the slope meter needs; the last one is kept. `at_s`: instants of it, from
/// its begin, at which v is told too (SteadyState::own_v).
SteadyState run_in_cvode(const AnalogController& controller, const tracking::Reference& reference,
                         Hertz operating, std::size_t samples = 2048, const std::vector<double>& at_s = {});

/// From the turn at the end of a repeat to the new contact: slope detector (integrated from its circuit) and
/// switch. InputError when the slope never reaches the detector's threshold.
double switch_delay_s(const AnalogController& controller, const tracking::Reference& reference,
                      Hertz operating);

}  // namespace bodesmith::controller
