#pragma once

#include <functional>
#include <vector>

#include "circuit/circuit.hpp"

namespace bodesmith::circuit {

/// Output of the realised stages with ideal op-amps (without isolating resistors) for an input voltage, all
/// at rest before: every stage in controllable canonical form, classical Runge-Kutta of fourth order in steps
/// of at most `step_s` and a tenth of the fastest pole's time constant. Values at 0, step_s, 2 step_s, …
/// (count of them).
std::vector<double> simulate_stages(const Circuit& circuit, const std::function<double(double)>& input,
                                    double step_s, int count);

}  // namespace bodesmith::circuit
