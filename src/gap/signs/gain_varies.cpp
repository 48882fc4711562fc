#include <algorithm>
#include <cmath>
#include <numbers>

#include "gap/search_options.hpp"
#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::gap {
namespace {

/// Slow cosines of which the gain is made, the constant aside.
constexpr auto kCosines = static_cast<Eigen::Index>(kNeighbours);

Eigen::VectorXd less_mean(const std::vector<double>& v) {
  const auto e = as_eigen(v);
  return e.array() - e.mean();
}

/// Orthonormal columns: output times slow cosines, made orthogonal to a constant and to the output itself (which are the
/// fit's business).
Eigen::MatrixXd varying_gains(const std::vector<double>& output) {
  const auto y = as_eigen(output);
  const Eigen::Index n = y.size();
  Eigen::MatrixXd x(n, kCosines + 2);
  x.col(0).setOnes();
  for (Eigen::Index k = 0; k <= kCosines; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      x(i, k + 1) = y(i) * std::cos(std::numbers::pi * static_cast<double>(k) *
                                    (static_cast<double>(i) + 0.5) / static_cast<double>(n));
    }
  }
  return orthonormal_columns(x).rightCols(kCosines);
}

}  // namespace

Sign gain_varies(const Leftover& record) {
  Sign sign{SignKind::gain_varies, 0.0};
  const Eigen::MatrixXd gains = varying_gains(record.output);
  // What they take over what they leave: of few lines they take much by chance, and leave much.
  const auto odds = [](double share) { return share / std::max(1.0 - share, 1e-6); };
  const auto figure = [&](const std::vector<double>& residual) {
    const Eigen::VectorXd e = less_mean(residual);
    return odds((gains.transpose() * e).squaredNorm() / std::max(e.squaredNorm(), 1e-300));
  };
  const double least = std::max(odds(kLeastShare), chance_limit(record.residual, figure));
  sign.strength = figure(record.residual) / least;
  return sign;
}

}  // namespace bodesmith::gap
