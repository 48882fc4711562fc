#pragma once

#include "fit/cascade_bands.hpp"

namespace bodesmith {

/// CascadeFitOptions::fitted_terms terms whose corners are searched, within a decade beyond base and last point, and with
/// ratios of up to 1000; bounds of the orders hold. Throws InputError when there are fewer than three points a term.
BandSolution fit_corners(const CascadeProblem& problem, const CascadeFitOptions& options);

}  // namespace bodesmith
