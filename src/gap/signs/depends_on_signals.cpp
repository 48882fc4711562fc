#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/evidence/noise_floor.hpp"
#include "gap/search_options.hpp"
#include "gap/signs/chance.hpp"
#include "gap/signs/signal_features.hpp"
#include "gap/signs/signs.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

using Eigen::Index;

/// Earlier samples by which noise tells the next one: white, red, falling as 1/f or ringing with a mode or two. With half as many 1/f is
/// less well followed; twice as many follow what is sought, too.
constexpr Index kMemory = 8;

/// e(t) = x(t) - sum_j memory_j x(t - j), column by column, from the first sample on that has all earlier ones.
Eigen::MatrixXd innovations(const Eigen::MatrixXd& x, const Eigen::VectorXd& memory) {
  const Index n = x.rows() - kMemory;
  Eigen::MatrixXd e = x.bottomRows(n);
  for (Index j = 0; j < kMemory; ++j) e -= memory(j) * x.middleRows(kMemory - 1 - j, n);
  return e;
}

Eigen::MatrixXd stacked(const std::vector<Eigen::MatrixXd>& parts, const Eigen::VectorXd& memory) {
  std::vector<Eigen::MatrixXd> all;
  Index rows = 0;
  for (const auto& part : parts) rows += all.emplace_back(innovations(part, memory)).rows();
  Eigen::MatrixXd out(rows, all.front().cols());
  Index from = 0;
  for (const auto& e : all) {
    out.middleRows(from, e.rows()) = e;
    from += e.rows();
  }
  return out;
}

/// Autoregressive noise that several series have in common, by least squares.
struct Autoregression {
  Eigen::VectorXd memory;
  double variance = 0.0;  ///< of its innovations
};

Autoregression autoregression_of(const std::vector<Eigen::MatrixXd>& series) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(kMemory, kMemory);
  Eigen::VectorXd along = Eigen::VectorXd::Zero(kMemory);
  for (const auto& x : series) {
    const Index n = x.rows() - kMemory;
    Eigen::MatrixXd earlier(n, kMemory);
    for (Index j = 0; j < kMemory; ++j) earlier.col(j) = x.col(0).segment(kMemory - 1 - j, n);
    information += gram(earlier);
    along += transpose_times(earlier, x.col(0).tail(n));
  }
  information.diagonal().array() += kLeastRest * kLeastRest * information.trace();  // rounding
  Autoregression noise{solve_ldlt(information, along), 0.0};
  noise.variance = stacked(series, noise.memory).col(0).array().square().mean();
  return noise;
}

}  // namespace

Sign depends_on_signals(const std::vector<Leftover>& records) {
  const auto scales = signal_scales(records);
  std::vector<Eigen::MatrixXd> residuals;
  std::vector<Eigen::MatrixXd> features;
  double energy = 0.0;
  for (const auto& r : records) {
    // A line is a sign of its own.
    residuals.emplace_back(as_eigen(less_straight_line(r.residual)));
    features.push_back(signal_features(r, scales));
    energy += residuals.back().squaredNorm();
  }

  // Beforehand no weight makes much more than twice the residual.
  const Index count = features.front().cols();
  Eigen::RowVectorXd sizes = Eigen::RowVectorXd::Zero(count);
  for (const auto& x : features) sizes += x.colwise().squaredNorm();
  for (auto& x : features)
    x *= (2.0 * std::sqrt(energy) * sizes.cwiseMax(1e-300).cwiseSqrt().cwiseInverse()).asDiagonal();

  const Autoregression alone = autoregression_of(residuals);
  const Eigen::MatrixXd white = stacked(features, alone.memory);
  Eigen::MatrixXd information = gram(white) / alone.variance;
  information.diagonal().array() += 1.0;
  const Eigen::VectorXd weights = solve_ldlt(
      information, transpose_times(white, stacked(residuals, alone.memory).col(0)) / alone.variance);
  const double freedom = static_cast<double>(count) -
                         solve_ldlt_columns(information, Eigen::MatrixXd::Identity(count, count)).trace();
  double left = 0.0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    residuals[k].col(0) -= times(features[k], weights);
    left += residuals[k].squaredNorm();
  }
  const double foretold = std::clamp(autoregression_of(residuals).variance / alone.variance, 1e-12, 1.0);
  // Of few samples as many as what was fitted leaves them (Bartlett, Proc. R. Soc. Lond. A 160 (1937) 268).
  const double n = static_cast<double>(white.rows() - kMemory) - 0.5 * freedom;
  const double deviations = (-n * std::log(foretold) - freedom) / std::sqrt(2.0 * freedom);
  const double share = 1.0 - std::min(left / energy, foretold);
  return {SignKind::depends_on_signals, std::min(deviations / kDeviations, share / kLeastShare)};
}

}  // namespace bodesmith::gap
