#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "base/units.hpp"
#include "lti/cascade.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith {

/// How the orders beta_i of a cascade (disturbance paper, eq. 15) are found from target gains.
struct CascadeFitOptions {
  /// The frequency of gain 1 at which the first band starts. Without it the lowest point. A point of the file
  /// at this frequency is the base and its gain becomes the cascade's gain; points below are left out.
  std::optional<Hertz> base{};
  /// |beta| <= beta_max: least squares (eq. 19 with a bound that may have either sign). Without it:
  /// interpolation of every point above the base (eq. 18).
  std::optional<double> beta_max{};
  /// 0 <= beta <= beta_max, the bound as eq. 19 prints it. The paper's 0 < beta is open; the least squares
  /// minimum over it usually lies on 0, so 0 counts as allowed, and such a term is exactly 1.
  bool beta_positive = false;
  /// c_i of eq. 19: a bound of its own for every term, in their order; in place of beta_max.
  std::vector<double> term_beta_max{};
  /// lambda_i and x_i of the terms as given (their beta is not looked at), in place of bands between points.
  std::vector<FractionalLeadLag> corners{};
  /// So many terms whose lambda_i and x_i are fitted too, from bands spread evenly over log frequency, by Levenberg and
  /// Marquardt about the (bounded) least squares of their orders: a minimum near that start. Above 0: three numbers
  /// a term, so at least three points for each.
  int fitted_terms = 0;
  /// Further ends of bands, between points: what splits a band. The curve is held to the straight line (in log gain
  /// over log frequency) there with a weight of 1e-4, which decides what the points leave open.
  std::vector<Hertz> splits{};

  bool bounded() const { return beta_max.has_value() || !term_beta_max.empty(); }
  /// Fewest bands: only some of the points start and end bands, the orders are fitted to all of them (least
  /// squares), and the fewest bands are taken with which the curve is within this of every point.
  std::optional<double> fewest_bands_db{};
  /// A curve that leaves the range of its two neighbouring points by more than this is warned about, and so
  /// is a point whose leaving out changes the curve by more than this.
  double surprise_db = 0.5;
};

/// One band and what its order means.
struct CascadeFitTerm {
  Band band;
  double beta = 0.0;
  bool rises = false;     ///< the magnitude rises over the band (a lead); otherwise it falls (a lag)
  bool at_bound = false;  ///< the bounded fit ended on a bound of this order
  std::optional<double> beta_max{};  ///< the order's own bound, when bounded
  double max_sensitivity = 0.0;      ///< largest |change of beta| for a gain error of +1 % in any one point
};

/// What happens to the curve when one point is left out and the others are fitted again.
struct LeftOutPoint {
  Hertz frequency;             ///< of the point that was left out
  double error_db = 0.0;       ///< curve without it minus its target, at the point
  double max_change_db = 0.0;  ///< largest difference of the two curves between base and last point
  Hertz max_change_at;
};

/// Where the curve leaves what its two neighbouring points span.
struct Excursion {
  Band between;
  Hertz worst;
  double outside_db = 0.0;  ///< how far outside [min, max] of the two targets
};

/// A fitted cascade, and everything a person needs to judge it. Nothing here is an exception: ill
/// conditioning and surprises are data.
struct CascadeFit {
  Cascade cascade;  ///< with its `fit` summary (the base is not one of its points)
  Hertz base;
  /// Magnitude at the base relative to its target: a consequence, not a condition.
  double base_got_db = 0.0;
  bool bounded = false;
  bool least_squares = false;  ///< fewer terms than points, and no bounds
  bool fewest_bands = false;   ///< the bands were chosen; then the fit is least squares over all points
  bool limit_met = true;       ///< of fewest_bands_db
  double lower_bound = 0.0;    ///< of every beta, when bounded
  double upper_bound = 0.0;
  /// Largest violation of the optimality (Karush-Kuhn-Tucker) conditions of the least squares problem, in Np:
  /// 0 up to rounding proves the global optimum, since the problem is strictly convex. 0 for interpolation.
  double optimality_residual = 0.0;
  double condition_number = 0.0;  ///< of eq. 18's matrix, 2-norm
  std::vector<CascadeFitTerm> terms;
  /// sensitivity[i][j]: change of beta_i when the target of fit point j grows by 1 %.
  std::vector<std::vector<double>> sensitivity;
  std::vector<Excursion> excursions;     ///< those over surprise_db
  std::vector<LeftOutPoint> left_out;    ///< every interior point
  std::vector<Hertz> points_below_base;  ///< in the file, not fitted
  std::vector<std::string> warnings;     ///< sentences for a person

  /// cascade.json without the header: gain, terms, fit with all the fields above.
  Json to_json() const;
};

/// Finds beta so that |G(j 2 pi f_i)| meets the target gains (disturbance paper, eq. 18 or 19), with
///   lambda_i = 1/(2 pi f_i), x_i = f_i / f_(i+1), f_0 = base, f_1... the points above it.
/// unless corners are given or fitted. Solved in nepers, in extended precision: by QR (interpolation) or by an active-set method for
/// box-constrained least squares whose result carries its optimality certificate. Weights multiply the
/// squared errors. Throws InputError when there is no point above the base, or beta_max is not above 0.
CascadeFit fit_cascade(const BodePoints& points, const CascadeFitOptions& options = {});

}  // namespace bodesmith
