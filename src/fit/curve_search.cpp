#include "fit/curve_search.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/dense.hpp"
#include "numeric/index.hpp"
#include "numeric/tall_matrix.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Magnitudes at so many frequencies are worked out root by root.
constexpr Index kDense = 100;

}  // namespace

void curve_errors(const RootModel& model, const CurveTarget& target, const VectorXd& theta, VectorXd& error,
                  MatrixXd* slope) {
  const Index n = eigen_index(target.frequency.size());
  const bool phase = target.has_phase();
  error.resize(phase ? 2 * n : n);
  if (slope != nullptr) slope->resize(error.size(), theta.size());
  if (!phase && n >= kDense) {
    RootResponse(model, theta).levels(target.frequency, error, slope);
    error = as_eigen(target.weight).cwiseProduct(error - as_eigen(target.log_gain));
    if (slope != nullptr) slope->array().colwise() *= as_eigen(target.weight).array();
    return;
  }
  Eigen::RowVectorXcd row(theta.size());
  const RootResponse response(model, theta);
  for (Index i = 0; i < n; ++i) {
    const std::size_t at = std_index(i);
    const auto value = response.at(target.frequency[at], slope != nullptr ? &row : nullptr, phase);
    const double weight = target.weight[at];
    error(i) = weight * (value.real() - target.log_gain[at]);
    if (slope != nullptr) slope->row(i) = weight * row.real();
    if (phase) {
      error(n + i) = weight * (value.imag() - target.phase_rad[at]);
      if (slope != nullptr) slope->row(n + i) = weight * row.imag();
    }
  }
}

SearchResult search_least_squares(const RootModel& model, const ErrorFunction& errors_at,
                                  const RootLimits& limits, VectorXd theta, int iterations) {
  clamp(model, limits, theta);
  VectorXd error;
  MatrixXd slope;
  errors_at(theta, error, &slope);
  double value = error.squaredNorm();
  double damping = 1e-2;
  int small = 0;
  for (int i = 0; i < iterations && damping < 1e10; ++i) {
    const TallMatrix rows(slope);
    const MatrixXd normal = rows.gram(VectorXd::Ones(slope.rows()));
    const VectorXd downhill = -rows.transpose_times(error);
    MatrixXd damped = normal;
    damped.diagonal().array() +=
        damping * (1e-6 * normal.diagonal().maxCoeff() + normal.diagonal().array()) + 1e-14;
    VectorXd step = solve_ldlt(damped, downhill);
    const double largest = step.tail(step.size() - 1).cwiseAbs().maxCoeff();
    if (largest > 1.5) step *= 1.5 / largest;
    VectorXd trial = theta + step;
    clamp(model, limits, trial);
    VectorXd trial_error;
    errors_at(trial, trial_error, nullptr);
    const double trial_value = trial_error.squaredNorm();
    if (trial_value < value) {
      small = value - trial_value < 1e-6 * value ? small + 1 : 0;
      theta = trial;
      value = trial_value;
      errors_at(theta, error, &slope);
      damping = std::max(1e-9, damping / 5.0);
      if (small > 3) break;
    } else {
      damping *= 4.0;
    }
  }
  return {theta, std::sqrt(value / static_cast<double>(error.size()))};
}

SearchResult search_least_squares(const RootModel& model, const CurveTarget& target, const RootLimits& limits,
                                  VectorXd theta, int iterations) {
  const ErrorFunction errors_at = [&](const VectorXd& at, VectorXd& error, MatrixXd* slope) {
    curve_errors(model, target, at, error, slope);
  };
  return search_least_squares(model, errors_at, limits, std::move(theta), iterations);
}

}  // namespace bodesmith
