#pragma once

#include <optional>
#include <vector>

#include "fit/cascade/cascade_fit.hpp"
#include "lti/cascade.hpp"
#include "numeric/optimisation/bounded_least_squares.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith {

/// The base and the points above it, gains relative to the base.
struct CascadeProblem {
  Hertz base;
  double base_gain = 1.0;
  std::vector<BodePoint> above;
  std::vector<Hertz> below;  ///< left out

  /// Target at a point, relative to the base.
  double target_db(const BodePoint& point) const { return to_decibel(point.gain / base_gain); }
};

/// Throws InputError when there is no point above the base.
CascadeProblem make_cascade_problem(const BodePoints& points, std::optional<Hertz> base);

/// The orders of terms with given corners.
struct BandSolution {
  std::vector<FractionalLeadLag> terms;
  LongMatrix matrix;       ///< of eq. 18: ln |G_i| of an order of 1, a row a point
  std::vector<int> bound;  ///< see BoundedSolution
  double optimality_residual = 0.0;
  std::vector<double> lower;  ///< of each order, when bounded
  std::vector<double> upper;

  /// The curve relative to the base.
  double curve_db(Hertz f) const;
};

/// The terms of bands that end at those points, the first one beginning at the base; their orders are 1.
std::vector<FractionalLeadLag> make_bands(Hertz base, const std::vector<BodePoint>& ends);
/// The orders of those terms, fitted to all of `above`. Throws InputError when there are more terms than points, or
/// bounds for another number of terms.
BandSolution solve_orders(const CascadeProblem& problem, std::vector<FractionalLeadLag> terms,
                          const std::vector<BodePoint>& above, const CascadeFitOptions& options);
/// The same of bands that end at `ends`.
BandSolution solve_bands(const CascadeProblem& problem, const std::vector<BodePoint>& ends,
                         const std::vector<BodePoint>& above, const CascadeFitOptions& options);

/// The fewest points at which bands end so that the curve is within the limit at every point.
struct BandChoice {
  std::vector<BodePoint> ends;
  bool limit_met = false;
};
BandChoice choose_bands(const CascadeProblem& problem, const CascadeFitOptions& options, double limit_db);

}  // namespace bodesmith
