#include "numeric/preview_tracking.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

/// y_i = x_i, x_{i+1} = 0.6 x_i + 0.1 u_i + 0.3 u_{i+1}.
PreviewSystem first_order() {
  PreviewSystem out;
  Eigen::Matrix3d a;
  a << 0.6, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  out.a.emplace_back(a);
  out.b.emplace_back(Eigen::Vector3d(0.3, 1.0, 0.0));
  out.g.emplace_back(Eigen::Vector3d(1.0, 0.0, 0.0));
  return out;
}

TEST(PreviewTracking, IsTheLeastSquaresSolution) {
  constexpr Eigen::Index n = 12;
  const PreviewSystem system = first_order();
  const PreviewWeights weights{std::vector<double>(n, 1.0), 0.02, 0.3, 0.5};
  PreviewTargets targets;
  for (int i = 0; i < n; ++i) {
    targets.e.push_back(std::sin(0.7 * i));
    targets.d.push_back(0.1 * std::cos(1.0 * i));
    targets.v.push_back(0.2 * i);
    targets.w.push_back(-0.05 * i);
  }
  const Eigen::Vector3d start(1.0, 1.0, 1.0);  // at rest under the first input
  const std::vector<double> u =
      PreviewTracking(system, weights).solve(targets, start, Eigen::Vector3d::Zero());

  // The same sum by its normal equations, every input the unit vector once.
  Eigen::MatrixXd rows(4 * n, n);
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(4 * n);
  rows.setZero();
  for (Eigen::Index k = 0; k < n; ++k) {
    double x = k == 0 ? 1.0 : 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i > 0) x = 0.6 * x + 0.1 * (i - 1 == k ? 1.0 : 0.0) + 0.3 * (i == k ? 1.0 : 0.0);
      rows(i, k) = x;
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    wanted(i) = targets.e[at];
    rows(n + i, i) = std::sqrt(weights.value);
    wanted(n + i) = std::sqrt(weights.value) * targets.v[at];
    if (i + 1 == n) break;
    const double bend = std::sqrt(weights.curvature);
    rows(2 * n + i, i + 1) += bend;
    rows(2 * n + i, i) -= 2.0 * bend;
    rows(2 * n + i, i > 0 ? i - 1 : 0) += bend;
    wanted(2 * n + i) = -bend * targets.d[at];
    const double rate = std::sqrt(weights.rate);
    rows(3 * n + i, i + 1) = rate;
    rows(3 * n + i, i) = -rate;
    wanted(3 * n + i) = rate * targets.w[at];
  }
  const Eigen::VectorXd best = least_norm_columns(rows, wanted);
  for (Eigen::Index i = 0; i < n; ++i) EXPECT_NEAR(u[static_cast<std::size_t>(i)], best(i), 1e-10) << i;
}

// A system that is another one at each step, from a state that is given: no other input has a smaller sum.
TEST(PreviewTracking, FollowsASystemThatChangesFromAGivenState) {
  constexpr std::size_t n = 8;
  PreviewSystem system;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i);
    Eigen::Matrix3d a;
    a << 0.6 - 0.05 * t, 0.1 + 0.02 * t, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0;
    system.a.emplace_back(a);
    system.b.emplace_back(Eigen::Vector3d(0.3 + 0.04 * t, 1.0, 0.0));
    system.g.emplace_back(Eigen::Vector3d(1.0 + 0.1 * t, 0.2, 0.0));
  }
  const PreviewWeights weights{std::vector<double>(n, 1.0), 0.02, 0.3, 0.5};
  PreviewTargets targets;
  for (std::size_t i = 0; i < n; ++i) targets.e.push_back(std::cos(0.9 * static_cast<double>(i)));
  const Eigen::Vector3d fixed(0.7, 0.4, 0.1);
  const std::vector<double> u = PreviewTracking(system, weights).solve(targets, {}, fixed);
  EXPECT_EQ(u[0], 0.4);
  const auto sum = [&](const std::vector<double>& v) {
    double out = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double y = system.g[i].dot(system.state_after(fixed, v, i));
      out += (y - targets.e[i]) * (y - targets.e[i]);
      if (i > 0) out += weights.value * v[i] * v[i];
      if (i + 1 == n) break;
      const double before = i > 0 ? v[i - 1] : fixed(2);
      const double bend = v[i + 1] - 2.0 * v[i] + before, rate = v[i + 1] - v[i];
      out += weights.curvature * bend * bend + weights.rate * rate * rate;
    }
    return out;
  };
  const double least = sum(u);
  for (std::size_t i = 1; i < n; ++i) {
    for (const double step : {1e-3, -1e-3}) {
      std::vector<double> moved = u;
      moved[i] += step;
      EXPECT_GT(sum(moved), least) << i;
    }
  }
}

TEST(PreviewTracking, TheInverseOfAnUnstableZeroIsBounded) {
  // y_i = u_{i-1} - 2 u_i: its zero lies at 1/2 of z^-1, the causal inverse grows as 2^i when run the wrong way.
  PreviewSystem system = first_order();
  system.a[0] << 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  system.b[0] << 0.0, 1.0, 0.0;
  system.g[0] << 0.0, 1.0, -3.0;
  const std::size_t n = 400;
  PreviewTargets targets;
  for (std::size_t i = 0; i < n; ++i) targets.e.push_back(std::sin(0.05 * static_cast<double>(i)));
  const std::vector<double> u = PreviewTracking(system, {std::vector<double>(n, 1.0), 1e-8, 0.0, 0.0})
                                    .solve(targets, Eigen::Vector3d(0.0, 1.0, 1.0), Eigen::Vector3d::Zero());
  for (std::size_t i = 12; i + 20 < n; ++i) {
    EXPECT_LT(std::abs(u[i]), 2.0);
    EXPECT_NEAR(u[i] - 3.0 * u[i - 1], targets.e[i], 1e-5) << i;
  }
}

}  // namespace
}  // namespace bodesmith
