#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "fit/root_model.hpp"

namespace bodesmith {

/// What |H| (and, if asked, arg H) should be at given frequencies.
struct CurveTarget {
  std::vector<RadPerSecond> frequency;
  std::vector<double> log_gain;   ///< Np
  std::vector<double> weight;     ///< multiplies the miss
  std::vector<double> phase_rad;  ///< empty: magnitude only
  /// Masks on ln|H|: rows of (frequency, limit, +1 upper / -1 lower).
  struct Mask {
    RadPerSecond frequency;
    double log_gain;
    int side;
  };
  std::vector<Mask> masks;
};

struct SearchResult {
  Eigen::VectorXd theta;
  double value = 0.0;  ///< weighted rms (least squares) or largest weighted miss (Chebyshev), Np
};

/// Weighted misses and their derivatives.
void curve_misses(const RootModel& model, const CurveTarget& target, const Eigen::VectorXd& theta,
                  Eigen::VectorXd& miss, Eigen::MatrixXd* slope);

/// Misses at theta and (unless null) their derivatives.
using Misses =
    std::function<void(const Eigen::VectorXd& theta, Eigen::VectorXd& miss, Eigen::MatrixXd* slope)>;

/// Levenberg-Marquardt inside the limits. Fast, for screening starts.
SearchResult search_least_squares(const RootModel& model, const Misses& misses, const RootLimits& limits,
                                  Eigen::VectorXd theta, int iterations);
/// The same for a curve; masks are left aside.
SearchResult search_least_squares(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  Eigen::VectorXd theta, int iterations);

/// Sequential programming in a trust region: rms or largest miss, with the limits and masks as constraints
/// (masks elastic).
SearchResult search_constrained(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                Eigen::VectorXd theta, bool least_squares, int iterations);

/// Moves theta by the smallest steps until every miss is 0 (more parameters than points).
SearchResult search_interpolation(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  Eigen::VectorXd theta, int iterations);

}  // namespace bodesmith
