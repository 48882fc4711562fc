#pragma once

#include "tolerance/judge.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::yield {

/// Everything that is known before the first sample: the ranges of the histograms, the worst case and the
/// ranking of the parts, from the sensitivities.
Result expected_result(const Design& design, const Options& options, const Judge& judge);

}  // namespace bodesmith::yield
