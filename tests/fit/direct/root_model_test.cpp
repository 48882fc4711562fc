#include "fit/direct/root_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace bodesmith {
namespace {

/// Two real zeros, a pair of zeros, a real pole and two pairs of poles, of which one is two real roots.
RootModel seven_roots() {
  RootModel model;
  model.real_zeros = 2;
  model.zero_pairs = 1;
  model.real_poles = 1;
  model.pole_pairs = 2;
  model.reference = RadPerSecond{3.0};
  return model;
}
Eigen::VectorXd its_numbers() {
  Eigen::VectorXd theta(12);
  theta << 0.4, -1.0, 1.5, 0.7, -1.2, -0.3, 0.2, -0.9, 1.1, 0.6, 2.0, 0.0;
  return theta;
}
std::vector<RadPerSecond> some_frequencies() {
  std::vector<RadPerSecond> out;
  for (const double w : {0.01, 0.7, 1.2, 2.4, 3.0, 9.0, 500.0}) out.push_back({w});  // no multiple of four
  return out;
}

TEST(RootModel, EveryWayToItsResponseIsTheProductOfItsRoots) {
  const RootModel model = seven_roots();
  ASSERT_EQ(model.size(), 10);
  const Eigen::VectorXd theta = its_numbers().head(model.size());
  const RootModel::Roots roots = model.roots(theta);
  ASSERT_EQ(roots.zeros.size(), 4u);
  ASSERT_EQ(roots.poles.size(), 5u);
  // Pairs by s^2 + 2 zeta w0 s + w0^2: the second one of the poles is two real roots.
  EXPECT_NEAR(std::abs(roots.zeros[2] * roots.zeros[3]), std::exp(2.0 * theta(3)), 1e-12);
  EXPECT_NEAR(-(roots.poles[3] + roots.poles[4]).real(), 2.0 * std::exp(theta(8) + theta(9)), 1e-12);
  EXPECT_NEAR((roots.poles[3] * roots.poles[4]).real(), std::exp(2.0 * theta(8)), 1e-12);
  EXPECT_EQ(roots.poles[3].imag(), 0.0);
  EXPECT_GT(roots.zeros[2].imag(), 0.0);
  const std::vector<RadPerSecond> w = some_frequencies();
  Eigen::VectorXcd h;
  Eigen::MatrixXcd h_slope(static_cast<Eigen::Index>(w.size()), model.size());
  Eigen::VectorXd level;
  Eigen::MatrixXd level_slope(static_cast<Eigen::Index>(w.size()), model.size());
  const RootResponse response(model, theta);
  response.values(w, h, &h_slope);
  response.levels(w, level, &level_slope);
  for (std::size_t i = 0; i < w.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    Complex product = roots.gain;
    double angle = 0.0;
    const Complex s(0.0, w[i].value);
    for (const Complex& z : roots.zeros) product *= s - z, angle += std::arg(s - z);
    for (const Complex& p : roots.poles) product /= s - p, angle -= std::arg(s - p);
    Eigen::RowVectorXcd slope;
    const Complex log_h = model.log_response(theta, w[i], &slope);
    EXPECT_NEAR(log_h.real(), std::log(std::abs(product)), 1e-12);
    EXPECT_NEAR(log_h.imag(), angle, 1e-12);
    EXPECT_EQ(response.at(w[i], nullptr, false), Complex(log_h.real(), 0.0));
    EXPECT_LT(std::abs(h(row) / product - 1.0), 1e-12);
    EXPECT_NEAR(level(row), log_h.real(), 1e-12);
    // The gain is that of the reference.
    if (i == 4) {
      EXPECT_NEAR(log_h.real(), theta(0), 1e-12);
    }
    for (Eigen::Index k = 0; k < model.size(); ++k) {
      Eigen::VectorXd more = theta, less = theta;
      more(k) += 1e-5;
      less(k) -= 1e-5;
      const Complex difference = (model.log_response(more, w[i]) - model.log_response(less, w[i])) / 2e-5;
      EXPECT_LT(std::abs(slope(k) - difference), 1e-8) << i << " " << k;
      EXPECT_LT(std::abs(h_slope(row, k) - difference), 1e-8) << i << " " << k;
      EXPECT_NEAR(level_slope(row, k), difference.real(), 1e-8) << i << " " << k;
    }
  }
}

// Forty zeros at 1e-3 rad/s, seen at 1e9: no number holds the square of their product.
TEST(RootModel, ManyRootsFarAwayDoNotOverflow) {
  for (const bool zeros : {true, false}) {
    RootModel model;
    (zeros ? model.real_zeros : model.real_poles) = 40;
    const Eigen::VectorXd theta = Eigen::VectorXd::Constant(41, std::log(1e-3));
    const Complex log_h = model.log_response(theta, RadPerSecond{1e9});
    const double wanted = theta(0) + (zeros ? 1.0 : -1.0) * 40.0 * (std::log(1e9) - 0.5 * std::log1p(1e-6));
    EXPECT_NEAR(log_h.real(), wanted, 1e-9);
  }
}

TEST(RootModel, ATrustRegionKeepsRootsWithinTheirLimits) {
  const RootModel model = seven_roots();
  const Eigen::VectorXd theta = its_numbers().head(model.size());
  RootLimits limits{RadPerSecond{0.05}, RadPerSecond{100.0}, 0.02};
  const double radius = 0.3;
  const LinearLimits held = trust_region_limits(model, limits, theta, radius);
  ASSERT_EQ(held.a.rows(), 2 * 3 + 4 * 3 + 2 * model.size());
  EXPECT_GE(held.b.minCoeff(), 0.0);
  // Corners by the roots themselves: of a pair that is two, the smaller and the larger one.
  const auto margins = [&](const Eigen::VectorXd& at) {
    std::vector<double> out;
    const RootModel::Roots roots = model.roots(at);
    const auto room = [&](const Complex& smaller, const Complex& larger) {
      out.push_back(std::log(100.0 / std::abs(larger)));
      out.push_back(std::log(std::abs(smaller) / 0.05));
    };
    const auto damping = [&](Eigen::Index k) {
      out.push_back(at(k) - std::log(0.02));
      out.push_back(std::log(1e6) - at(k));
    };
    room(roots.zeros[0], roots.zeros[0]);
    room(roots.zeros[1], roots.zeros[1]);
    damping(4);
    room(roots.zeros[2], roots.zeros[3]);
    room(roots.poles[0], roots.poles[0]);
    damping(7);
    room(roots.poles[1], roots.poles[2]);
    damping(9);
    room(roots.poles[3], roots.poles[4]);
    return out;
  };
  const std::vector<double> now = margins(theta);
  for (std::size_t row = 0; row < now.size(); ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    EXPECT_NEAR(held.b(r) * radius, now[row], 1e-9) << row;
    for (Eigen::Index k = 0; k < model.size(); ++k) {
      Eigen::VectorXd more = theta, less = theta;
      more(k) += 1e-6;
      less(k) -= 1e-6;
      EXPECT_NEAR(held.a(r, k), (margins(less)[row] - margins(more)[row]) / 2e-6, 1e-6) << row << " " << k;
    }
  }
  for (Eigen::Index k = 0; k < model.size(); ++k) {
    const Eigen::Index row = static_cast<Eigen::Index>(now.size()) + 2 * k;
    for (const Eigen::Index side : {0, 1}) {
      Eigen::RowVectorXd one = Eigen::RowVectorXd::Zero(model.size());
      one(k) = side == 0 ? 1.0 : -1.0;
      EXPECT_EQ(held.a.row(row + side), one);
      EXPECT_EQ(held.b(row + side), 1.0);
    }
  }
}

TEST(RootModel, ClampingMovesEveryRootIntoTheLimitsAndNoneThatIsThere) {
  const RootModel model = seven_roots();
  const RootLimits limits{RadPerSecond{0.5}, RadPerSecond{20.0}, 0.1};
  Eigen::VectorXd inside = its_numbers().head(model.size());
  inside(1) = std::log(0.6);
  inside(9) = 0.2;  // two roots that are near one another
  Eigen::VectorXd theta = inside;
  clamp(model, limits, theta);
  EXPECT_EQ(theta, inside);
  for (const double far : {-40.0, 40.0}) {
    for (const double damping : {-9.0, 0.5, 3.0, 15.0}) {
      theta = inside;
      theta(2) = theta(3) = theta(5) = theta(6) = far;
      theta(4) = theta(7) = theta(9) = damping;
      clamp(model, limits, theta);
      const RootModel::Roots roots = model.roots(theta);
      for (const auto* list : {&roots.zeros, &roots.poles}) {
        for (const Complex& root : *list) {
          EXPECT_GE(std::abs(root), 0.5 * (1.0 - 1e-9));
          EXPECT_LE(std::abs(root), 20.0 * (1.0 + 1e-9));
          EXPECT_LE(root.real(), -0.1 * std::abs(root) * (1.0 - 1e-9));
        }
      }
      EXPECT_EQ(theta(0), inside(0));
      // The pair that keeps its middle goes as far apart as it may, up to the nearer limit, and no farther.
      if (damping == 15.0) {
        EXPECT_NEAR(std::abs(roots.poles[3]), 0.5, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith
