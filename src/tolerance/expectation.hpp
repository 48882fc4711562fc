#pragma once

#include "tolerance/yield.hpp"

namespace bodesmith::yield {

/// Deviations beyond these are counted as these: a null of the response, dB.
constexpr double kMaxDeviationDb = 400.0;

/// Everything that is known before the first sample: the ranges of the histograms, the worst case and the
/// ranking of the parts, from the sensitivities.
Result expected_result(const Design& design, const Options& options);

}  // namespace bodesmith::yield
