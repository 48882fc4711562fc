#pragma once

#include <vector>

#include "fit/waveform_error.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith {

/// What no linear filter, causal or not, of any order beats, percent of range. Every harmonic of every operating
/// frequency is one physical frequency, and harmonics that coincide share one value of G: a small least squares problem.
/// For the worst frequency the largest weighted bound over the frequencies' weights is taken (each one is valid).
double waveform_lower_bound(const Disturbance& disturbance, const std::vector<Hertz>& operating,
                            DrivenPath path, bool worst);

}  // namespace bodesmith
