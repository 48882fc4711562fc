#pragma once

#include <string>
#include <vector>

#include "fit/cascade_bands.hpp"
#include "fit/cascade_fit.hpp"

namespace bodesmith {

/// d beta_i / d ln(gain_j) times ln 1.01; only orders that are not on a bound move. `weighted` when the orders are the
/// least squares of weighted points.
std::vector<std::vector<double>> order_sensitivities(const BandSolution& solution,
                                                     const std::vector<BodePoint>& above, bool weighted);

/// Where the curve leaves what two neighbouring points span by more than surprise_db.
std::vector<Excursion> find_excursions(const BandSolution& solution, const CascadeProblem& problem,
                                       double surprise_db);

/// Every interior point left out in turn; none when there are so many that it takes too long.
std::vector<LeftOutPoint> leave_out_each(const BandSolution& solution, const CascadeProblem& problem,
                                         const CascadeFitOptions& options);

/// What of all this a person should read.
std::vector<std::string> cascade_warnings(const CascadeFit& fit, const CascadeFitOptions& options);

}  // namespace bodesmith
