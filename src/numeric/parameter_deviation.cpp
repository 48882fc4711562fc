#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/least_squares.hpp"

namespace bodesmith {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Correlation of a residual from sample to sample, within [0, 0.999].
double sample_correlation(const Eigen::VectorXd& residual) {
  const double mean = residual.mean();
  double around = 0.0;
  double neighbour = 0.0;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    around += (residual(i) - mean) * (residual(i) - mean);
    if (i > 0) neighbour += (residual(i) - mean) * (residual(i - 1) - mean);
  }
  return around > 0.0 ? std::clamp(neighbour / around, 0.0, 0.999) : 0.0;
}

}  // namespace

Eigen::VectorXd parameter_deviation(const Eigen::MatrixXd& gram, const Eigen::VectorXd& residual) {
  const Eigen::Index n = gram.rows();
  const Eigen::Index samples = residual.size();
  if (samples <= n + 1) return Eigen::VectorXd::Constant(n, kInfinite);
  const double correlation = sample_correlation(residual);
  const double variance =
      residual.squaredNorm() / static_cast<double>(samples - n) * (1.0 + correlation) / (1.0 - correlation);
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale(i) = gram(i, i) > 0.0 ? 1.0 / std::sqrt(gram(i, i)) : 0.0;
  const SymmetricEigen eigen = symmetric_eigen(scale.asDiagonal() * gram * scale.asDiagonal());
  Eigen::VectorXd out(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = scale(i) > 0.0 ? 0.0 : kInfinite;
    for (Eigen::Index k = 0; k < n && std::isfinite(sum); ++k) {
      const double part = eigen.vectors(i, k) * eigen.vectors(i, k);
      if (eigen.values(k) <= 1e-13) {
        if (part > 1e-6) sum = kInfinite;
      } else {
        sum += part / eigen.values(k);
      }
    }
    out(i) = scale(i) > 0.0 ? scale(i) * std::sqrt(variance * sum) : kInfinite;
  }
  return out;
}

}  // namespace bodesmith
