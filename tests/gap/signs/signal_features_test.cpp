// Features by which a residual is predicted: of signals on one scale, whatever their units, and of either sign.
#include "gap/signs/signal_features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace features_of {
namespace {

using namespace bodesmith;

gap::Leftover record(double scale, double middle, double step_s, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  gap::Leftover out;
  out.step_s = step_s;
  double x = 0.0;
  for (int i = 0; i < 400; ++i) {
    x += 0.2 * (normal(random) - x);
    out.input.push_back(scale * x + middle);
    out.output.push_back(scale * (x + 0.3 * std::tanh(2.0 * x) * x) - middle);
  }
  return out;
}

Eigen::MatrixXd features(const gap::Leftover& r) {
  return gap::signal_features(r, gap::signal_scales({r, r}));
}

TEST(SignalFeatures, DoNotDependOnUnitsAndHaveNoMean) {
  const Eigen::MatrixXd one = features(record(1.0, 0.0, 1e-3));
  const Eigen::MatrixXd other = features(record(64.0, 3.0, 0.25));
  ASSERT_EQ(one.rows(), 400);
  ASSERT_EQ(one.cols(), other.cols());
  EXPECT_LT((one - other).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(one.colwise().mean().cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SignalFeatures, AreAllDifferentAndNoneIsNothing) {
  const Eigen::MatrixXd all = features(record(1.0, 0.0, 1e-3));
  for (Eigen::Index k = 0; k < all.cols(); ++k) {
    ASSERT_GT(all.col(k).norm(), 1e-3) << k;
    for (Eigen::Index i = 0; i < k; ++i)
      EXPECT_LT(std::abs(all.col(k).normalized().dot(all.col(i).normalized())), 1.0 - 1e-6) << k << " " << i;
  }
}

// Signals turned over have the same features, each as it was or turned over, the ends of the range exchanged.
TEST(SignalFeatures, OfTurnedSignalsAreTheSameButForSigns) {
  gap::Leftover turned = record(1.0, 0.0, 1e-3);
  for (double& v : turned.input) v = -v;
  for (double& v : turned.output) v = -v;
  const auto first = record(1.0, 0.0, 1e-3);
  const auto scales = gap::signal_scales({first, turned});
  const Eigen::MatrixXd one = gap::signal_features(first, scales);
  const Eigen::MatrixXd other = gap::signal_features(turned, scales);
  for (Eigen::Index k = 0; k < one.cols(); ++k) {
    double nearest = 1e9;
    for (Eigen::Index i = 0; i < other.cols(); ++i)
      nearest = std::min({nearest, (one.col(k) - other.col(i)).norm(), (one.col(k) + other.col(i)).norm()});
    // But for the first samples of the input's branch, which begins as rising.
    EXPECT_LE(nearest, 0.1 * one.col(k).norm()) << k;
  }
}

TEST(SignalFeatures, ScalesAreOfAllRecords) {
  const auto scales = gap::signal_scales({record(1.0, 0.0, 1e-3), record(2.0, 0.5, 1e-3, 2)});
  const auto wide = record(2.0, 0.5, 1e-3, 2);
  const auto [low, high] = std::minmax_element(wide.input.begin(), wide.input.end());
  EXPECT_LE(scales.middle_u - scales.size_u, *low + 1e-12);
  EXPECT_GE(scales.middle_u + scales.size_u, *high - 1e-12);
  EXPECT_LT(gap::signal_features(wide, scales).col(0).cwiseAbs().maxCoeff(), 2.0);
}

}  // namespace
}  // namespace features_of
