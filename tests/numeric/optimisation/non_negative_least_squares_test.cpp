#include "numeric/optimisation/non_negative_least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "numeric/linear_algebra/dense.hpp"
#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  MatrixXd a;
  VectorXd b;
};

Problem random_problem(Index rows, Index columns, std::uint64_t seed) {
  Random random(seed);
  Problem p{MatrixXd(rows, columns), VectorXd(rows)};
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) p.a(i, j) = random.normal();
    p.b(i) = random.normal();
  }
  return p;
}

/// The Kuhn-Tucker conditions of min |A x − b|², x >= 0.
void expect_optimal(const Problem& p, const VectorXd& x, double tolerance) {
  const VectorXd gradient = transpose_times(p.a, times(p.a, x) - p.b);
  for (Index i = 0; i < x.size(); ++i) {
    if (x(i) > 0.0) {
      EXPECT_NEAR(gradient(i), 0.0, tolerance) << i;
    } else {
      EXPECT_EQ(x(i), 0.0) << i;
      EXPECT_GT(gradient(i), -tolerance) << i;
    }
  }
}

TEST(NonNegative, ItSatisfiesKuhnAndTucker) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Problem p = random_problem(80, 30, 100 + seed);
    LinearMap map{30, 80, [&](const VectorXd& x, VectorXd& y) { y = times(p.a, x); },
                  [&](const VectorXd& r, VectorXd& g) { g = transpose_times(p.a, r); }};
    const VectorXd scale = p.a.colwise().norm().cwiseInverse();
    const auto found = non_negative_least_squares(
        map, p.b, VectorXd::Zero(30), scale, {.tolerance = 1e-12, .max_iterations = 5000, .min_gain = 0.0});
    EXPECT_EQ(found.termination, Termination::gradient);
    expect_optimal(p, found.x, 1e-8);
    EXPECT_NEAR(found.cost, 0.5 * (times(p.a, found.x) - p.b).squaredNorm(), 1e-9);
  }
}

TEST(NonNegative, TheUnitOfTheRightSideIsThatOfTheSolution) {
  const Problem p = random_problem(40, 12, 7);
  LinearMap map{12, 40, [&](const VectorXd& x, VectorXd& y) { y = times(p.a, x); },
                [&](const VectorXd& r, VectorXd& g) { g = transpose_times(p.a, r); }};
  const auto of_unit = [&](double unit) {
    return non_negative_least_squares(map, unit * p.b, VectorXd::Zero(12), VectorXd::Ones(12), {});
  };
  const NonNegativeResult one = of_unit(1.0);
  for (const double unit : {std::ldexp(1.0, -330), std::ldexp(1.0, 330)}) {
    const NonNegativeResult found = of_unit(unit);
    EXPECT_EQ(found.x, unit * one.x);
    EXPECT_EQ(found.kkt, one.kkt);
    EXPECT_EQ(found.iterations, one.iterations);
  }
}

TEST(NonNegative, AColumnOfScaleZeroStaysAtZero) {
  const Problem p = random_problem(20, 3, 9);
  LinearMap map{3, 20, [&](const VectorXd& x, VectorXd& y) { y = times(p.a, x); },
                [&](const VectorXd& r, VectorXd& g) { g = transpose_times(p.a, r); }};
  VectorXd scale = VectorXd::Ones(3);
  scale(1) = 0.0;
  const auto found = non_negative_least_squares(map, p.b, VectorXd::Ones(3), scale, {});
  EXPECT_EQ(found.x(1), 0.0);
}

}  // namespace
}  // namespace bodesmith
