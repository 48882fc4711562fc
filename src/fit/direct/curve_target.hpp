#pragma once

#include <Eigen/Core>

#include <functional>
#include <vector>

#include "base/units.hpp"
#include "fit/direct/root_model.hpp"
#include "signal/bode_points.hpp"

namespace bodesmith {

/// What |H| (and, if asked, arg H) should be at given frequencies.
struct CurveTarget {
  std::vector<RadPerSecond> frequency;
  std::vector<double> log_gain;   ///< Np
  std::vector<double> weight;     ///< multiplies the error
  std::vector<double> phase_rad;  ///< unwrapped; empty: magnitude only
  /// A limit on ln|H|.
  struct Mask {
    RadPerSecond frequency;
    double log_gain;
    int side;  ///< +1 upper, -1 lower
  };
  std::vector<Mask> masks;

  bool has_phase() const { return !phase_rad.empty(); }
};

/// The points with a weight above 0. Throws InputError when there is none, or when one lacks its phase and `use_phase`.
CurveTarget make_curve_target(const BodePoints& points, bool use_phase);

/// Adds 80 frequencies of a mask given as gains, interpolated linearly in dB over log frequency within its range. A mask
/// of fewer than two points limits nothing.
void add_mask(CurveTarget& target, const BodePoints& mask, int side);

/// At most `max_points` of them, evenly over log frequency, always points of the data.
CurveTarget thinned(const CurveTarget& full, std::size_t max_points);

/// The points joined by straight lines in log-log, with a small weight between them: what keeps an underdetermined fit
/// calm.
CurveTarget joined(const CurveTarget& points, double weight);

/// Weighted mean of ln|H|.
double mean_log_gain(const CurveTarget& target);

struct SearchResult {
  Eigen::VectorXd theta;
  double value = 0.0;  ///< weighted rms (least squares) or largest weighted error (Chebyshev), Np
};

/// Weighted errors and their derivatives.
void curve_errors(const RootModel& model, const CurveTarget& target, const Eigen::VectorXd& theta,
                  Eigen::VectorXd& error, Eigen::MatrixXd* slope);

/// Errors at theta and (unless null) their derivatives.
using ErrorFunction =
    std::function<void(const Eigen::VectorXd& theta, Eigen::VectorXd& error, Eigen::MatrixXd* slope)>;

/// Levenberg-Marquardt inside the limits. Fast, for screening starts.
SearchResult search_least_squares(const RootModel& model, const ErrorFunction& errors_at,
                                  const RootLimits& limits, Eigen::VectorXd theta, int iterations);
/// The same for a curve; masks are left aside.
SearchResult search_least_squares(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  Eigen::VectorXd theta, int iterations);

}  // namespace bodesmith
