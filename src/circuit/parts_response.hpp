#pragma once

#include <complex>
#include <functional>
#include <span>

#include "circuit/circuit.hpp"

namespace bodesmith::circuit {

/// H(jw) of a stage with ideal op-amps for any values of its parts.
using PartsResponse = std::function<std::complex<double>(std::span<const double>, RadPerSecond)>;

/// Of a ladder's stage, -Z/R with the ladder in the feedback, -R/Z with it at the input, R the first of the values; null
/// for a stage that has a form.
PartsResponse ladder_response(const Stage& stage);

}  // namespace bodesmith::circuit
