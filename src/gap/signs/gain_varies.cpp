#include <algorithm>
#include <cmath>
#include <numbers>

#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::gap {
namespace {

/// Of few lines, slow gains make much by chance: there what they leave must be less, by odds this many times surrogates'
/// best.
constexpr double kGainTimesOdds = 4.0;
/// Slow cosines of which the gain is made, the constant aside.
constexpr Eigen::Index kCosines = 12;

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
  const auto share = [&](const std::vector<double>& residual) {
    const Eigen::VectorXd e = less_mean(residual);
    return (gains.transpose() * e).squaredNorm() / std::max(e.squaredNorm(), 1e-300);
  };
  const double got = share(record.residual);
  const Chance chance = on_surrogates(record.residual, share);
  const auto odds = [](double part) { return part / std::max(1.0 - part, 1e-6); };
  sign.strength = std::max(got / std::max(kLeastShare, chance.limit()),
                           got < kLeastShare ? 0.0 : odds(got) / (kGainTimesOdds * odds(chance.max())));
  return sign;
}

}  // namespace bodesmith::gap
