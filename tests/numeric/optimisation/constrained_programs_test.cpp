#include "numeric/optimisation/constrained_programs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "numeric/linear_algebra/dense.hpp"
#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

LevelProgram drawn(Random& random, Index rows, Index n, Index general) {
  LevelProgram p;
  const auto normal = [&random](Index) { return random.normal(); };
  p.error = VectorXd::NullaryExpr(rows, normal);
  p.slope = MatrixXd::NullaryExpr(rows, n, [&random](Index, Index) { return random.normal(); });
  p.lower = VectorXd::NullaryExpr(n, [&random](Index) { return -random.uniform(); });
  p.upper = VectorXd::NullaryExpr(n, [&random](Index) { return random.uniform(); });
  p.a = MatrixXd::NullaryExpr(general, n, [&random](Index, Index) { return random.normal(); });
  p.b = VectorXd::NullaryExpr(general, [&random](Index) { return random.uniform(); });
  return p;
}

/// The same by interior points.
double level_by_interior_points(const LevelProgram& p) {
  const Index rows = p.error.size(), n = p.slope.cols(), general = p.b.size();
  QuadraticProgram q;
  q.q = MatrixXd::Zero(n + 1, n + 1);
  q.c = VectorXd::Zero(n + 1);
  if (p.cost.size() > 0) q.c.head(n) = p.cost;
  q.c(n) = 1.0;
  q.a = MatrixXd::Zero(2 * rows + 2 * n + general, n + 1);
  q.b = VectorXd(q.a.rows());
  q.a.topLeftCorner(rows, n) = p.slope;
  q.a.block(rows, 0, rows, n) = -p.slope;
  q.a.topRightCorner(2 * rows, 1).setConstant(-1.0);
  q.b << -p.error, p.error, p.upper.cwiseMin(1e3), -p.lower, p.b;
  q.a.block(2 * rows, 0, n, n).setIdentity();
  q.a.block(2 * rows + n, 0, n, n) = -MatrixXd::Identity(n, n);
  q.a.bottomLeftCorner(general, n) = p.a;
  VectorXd start = VectorXd::Zero(n + 1);
  start(n) = 2.0 * p.error.cwiseAbs().maxCoeff();
  const QuadraticProgramResult found = solve_quadratic_program(q, start);
  return q.c.dot(found.x);
}

void expect_kept(const LevelProgram& p, const LevelResult& found) {
  EXPECT_LE((p.error + times(p.slope, found.x)).cwiseAbs().maxCoeff(), found.level * (1.0 + 1e-9) + 1e-13);
  EXPECT_GE((found.x - p.lower).minCoeff(), -1e-12);
  EXPECT_GE((p.upper - found.x).minCoeff(), -1e-12);
  if (p.b.size() > 0) {
    EXPECT_LE((times(p.a, found.x) - p.b).maxCoeff(), 1e-8);
  }
}

TEST(LeastLevel, AgreesWithInteriorPoints) {
  Random random(4);
  for (const Index rows : {1, 7, 40, 203}) {
    for (const Index n : {1, 3, 10, 18}) {
      for (const Index general : {0, 5}) {
        const LevelProgram p = drawn(random, rows, n, general);
        const LevelResult found = solve_least_level(p);
        ASSERT_TRUE(found.solved) << rows << " rows, " << n << " numbers, " << general << " inequalities";
        expect_kept(p, found);
        EXPECT_NEAR(found.level, level_by_interior_points(p), 1e-6 * (1.0 + found.level));
      }
    }
  }
}

TEST(LeastLevel, ANumberThatCostsGivesWayToInequalities) {
  Random random(9);
  LevelProgram p = drawn(random, 120, 6, 8);
  // The last number loosens all inequalities, which cannot be kept without it, and moves no error.
  p.slope.col(5).setZero();
  p.a.col(5).setConstant(-1.0);
  p.b.setConstant(-5.0);
  p.lower(5) = 0.0;
  p.upper(5) = std::numeric_limits<double>::infinity();
  p.cost = VectorXd::Zero(6);
  p.cost(5) = 100.0;
  const LevelResult found = solve_least_level(p);
  ASSERT_TRUE(found.solved);
  EXPECT_GT(found.x(5), 1.0);
  EXPECT_LE((times(p.a, found.x) - p.b).maxCoeff(), 1e-8);
  const double got = found.level + 100.0 * found.x(5);
  EXPECT_NEAR(got, level_by_interior_points(p), 1e-6 * got);
}

/// Chebyshev, 1853: of all monic polynomials of degree n the least on [-1, 1] is T_n/2^(n-1), of height 2^(1-n).
TEST(LeastLevel, FindsChebyshevsPolynomial) {
  const Index rows = 2001, n = 6;
  LevelProgram p;
  p.error.resize(rows);
  p.slope.resize(rows, n);
  for (Index i = 0; i < rows; ++i) {
    const double x = -1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(rows - 1);
    p.error(i) = std::pow(x, static_cast<double>(n));
    for (Index j = 0; j < n; ++j) p.slope(i, j) = std::pow(x, static_cast<double>(j));
  }
  p.lower = VectorXd::Constant(n, -10.0);
  p.upper = VectorXd::Constant(n, 10.0);
  const LevelResult found = solve_least_level(p);
  ASSERT_TRUE(found.solved);
  EXPECT_NEAR(found.level, std::pow(2.0, 1 - static_cast<int>(n)), 1e-6);
  // T_6 = 32 x^6 - 48 x^4 + 18 x^2 - 1.
  EXPECT_NEAR(found.x(4), -48.0 / 32.0, 1e-4);
  EXPECT_NEAR(found.x(2), 18.0 / 32.0, 1e-4);
  EXPECT_NEAR(found.x(0), -1.0 / 32.0, 1e-4);
  EXPECT_NEAR(found.x(1), 0.0, 1e-4);
}

TEST(LeastLevel, InequalitiesThatNothingKeepsAreNotSolved) {
  LevelProgram p;
  p.error = VectorXd::Ones(3);
  p.slope = MatrixXd::Ones(3, 1);
  p.lower = VectorXd::Constant(1, -1.0);
  p.upper = VectorXd::Constant(1, 1.0);
  p.a = MatrixXd::Ones(1, 1);
  p.b = VectorXd::Constant(1, -2.0);
  EXPECT_FALSE(solve_least_level(p).solved);
}

TEST(LeastLevel, RefusesColumnsOfDifferentLength) {
  LevelProgram p;
  p.error = VectorXd::Ones(3);
  p.slope = MatrixXd::Ones(2, 1);
  EXPECT_THROW(solve_least_level(p), std::logic_error);
}

}  // namespace
}  // namespace bodesmith
