#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/signs/chance.hpp"
#include "gap/signs/signal_features.hpp"
#include "gap/signs/signs.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// The ridge of the weights: grows with the residual's memory, as fewer effective samples carry fewer
/// features.
constexpr double kRidgePerSample = 0.3;
constexpr double kRidge = 1e-6;

Eigen::VectorXd zero_mean(const std::vector<double>& v) {
  const auto e = as_eigen(v);
  return e.array() - e.mean();
}

/// Share of one residual's energy that weights learned on the other explain.
class Prediction {
 public:
  Prediction(const Leftover& learn, const Leftover& apply) {
    const auto scales = signal_scales(learn, apply);
    x_ = signal_features(learn, scales);
    z_ = signal_features(apply, scales);
    for (Eigen::Index j = 0; j < x_.cols(); ++j) {
      const double size = std::max(x_.col(j).norm() / std::sqrt(static_cast<double>(x_.rows())), 1e-12);
      x_.col(j) /= size;
      z_.col(j) /= size;
    }
    gram_ = gram(x_);
    gram_.diagonal().array() +=
        kRidgePerSample * correlation_time(learn.residual) + kRidge * static_cast<double>(x_.rows());
  }
  double share(const std::vector<double>& learn, const std::vector<double>& apply) const {
    const Eigen::VectorXd f = zero_mean(apply);
    const Eigen::VectorXd weights = solve_ldlt(gram_, transpose_times(x_, zero_mean(learn)));
    const Eigen::VectorXd predicted = times(z_, weights);
    // One factor for the whole prediction keeps a change of amplitude from spoiling it.
    const double energy = predicted.squaredNorm();
    const double factor = energy > 0.0 ? std::clamp(predicted.dot(f) / energy, 0.0, 1.0) : 0.0;
    return 1.0 - (f - factor * predicted).squaredNorm() / std::max(f.squaredNorm(), 1e-300);
  }

 private:
  Eigen::MatrixXd x_;
  Eigen::MatrixXd z_;
  Eigen::MatrixXd gram_;  ///< of the features learned from, with the ridge
};

}  // namespace

Sign depends_on_signals(const Leftover& learn, const Leftover& apply) {
  Sign sign{SignKind::depends_on_signals, 0.0};
  // A line over a part says nothing of the other, and would hide what does.
  const auto learned = less_straight_line(learn.residual);
  const auto applied = less_straight_line(apply.residual);
  const Prediction prediction(learn, apply);
  Chance chance;
  for (std::uint64_t k = 0; k < kSurrogates; ++k)
    chance.add(prediction.share(phase_surrogate(learned, 1000 + k), phase_surrogate(applied, 2000 + k)));
  sign.strength = prediction.share(learned, applied) / std::max(kLeastShare, chance.limit());
  return sign;
}

}  // namespace bodesmith::gap
