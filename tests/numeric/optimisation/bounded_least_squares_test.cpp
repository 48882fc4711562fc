#include <gtest/gtest.h>

#include <limits>

#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/optimisation/bounded_least_squares.hpp"
#include "numeric/optimisation/constrained_programs.hpp"
#include "numeric/optimisation/population_search.hpp"
#include "numeric/parallel_for.hpp"
#include "numeric/random.hpp"

namespace bodesmith {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Many minima, the deepest at 0.5 in every direction (Rastrigin 1974, moved).
double rastrigin(const VectorXd& x) {
  double sum = 0.0;
  for (const double v : x) sum += (v - 0.5) * (v - 0.5) + 1.0 - std::cos(2.0 * std::numbers::pi * (v - 0.5));
  return sum;
}

TEST(DifferentialEvolution, FindsTheDeepestOfManyMinima) {
  const VectorXd low = VectorXd::Constant(3, -4.0), high = VectorXd::Constant(3, 4.0);
  const auto found = differential_evolution(rastrigin, low, high, {.generations = 400});
  EXPECT_LT(found.cost, 1e-4);
  EXPECT_EQ(found.x.size(), 3);
  // The same numbers give the same path.
  const auto again = differential_evolution(rastrigin, low, high, {.generations = 400});
  EXPECT_EQ(found.cost, again.cost);
  EXPECT_EQ(found.evaluations, again.evaluations);
}

TEST(ParticleSwarm, FindsTheDeepestOfManyMinimaWithinTheBounds) {
  const VectorXd low = VectorXd::Constant(3, -4.0), high = VectorXd::Constant(3, 0.4);
  const auto found = pso_cuckoo(rastrigin, low, high, {});
  for (const double v : found.x) EXPECT_NEAR(v, 0.4, 1e-3);  // the bound nearest to the minimum
}

/// Before the first generation the points are even over the box: mean in its middle, variance span²/12, unknowns without correlation.
TEST(PopulationSearch, BeginsEvenlyOverTheBox) {
  const VectorXd low = (VectorXd(2) << -4.0, 1.0).finished(), high = (VectorXd(2) << 2.0, 3.0).finished();
  for (const bool swarm : {false, true}) {
    const double count = 4000.0;
    VectorXd sum = VectorXd::Zero(2);
    MatrixXd squares = MatrixXd::Zero(2, 2);
    const auto cost = [&](const VectorXd& x) {
      const VectorXd unit = (x - low).cwiseQuotient(high - low) - VectorXd::Constant(2, 0.5);
      EXPECT_LE(unit.cwiseAbs().maxCoeff(), 0.5);
      sum += unit;
      squares += unit * unit.transpose();
      return x(0);
    };
    if (swarm)
      pso_cuckoo(cost, low, high, {.particles = 4000, .generations = 0});
    else
      differential_evolution(cost, low, high, {.population = 4000, .generations = 0});
    // Five standard errors: of a mean sqrt(1/12/count), of a square sqrt(1/180/count), of a product 1/12/sqrt(count).
    EXPECT_LT((sum / count).cwiseAbs().maxCoeff(), 5.0 * std::sqrt(1.0 / 12.0 / count));
    EXPECT_LT((squares / count - MatrixXd::Identity(2, 2) / 12.0).cwiseAbs().maxCoeff(),
              5.0 / 12.0 / std::sqrt(count));
  }
}

TEST(PopulationSearch, EndsWhenItIsAskedToStop) {
  const VectorXd low = VectorXd::Constant(3, -4.0), high = VectorXd::Constant(3, 4.0);
  ask_to_stop();
  EXPECT_THROW(differential_evolution(rastrigin, low, high, {}), Interrupted);
  EXPECT_THROW(pso_cuckoo(rastrigin, low, high, {}), Interrupted);
  forget_interruption();
}

TEST(QuadraticProgram, MeetsItsConstraints) {
  // min (x - 2)^2 + (y - 1)^2, x + y <= 2, x <= 1.2: at (1.2, 0.8) by hand.
  QuadraticProgram problem;
  problem.q = 2.0 * MatrixXd::Identity(2, 2);
  problem.c = (VectorXd(2) << -4.0, -2.0).finished();
  problem.a = (MatrixXd(2, 2) << 1.0, 1.0, 1.0, 0.0).finished();
  problem.b = (VectorXd(2) << 2.0, 1.2).finished();
  const auto found = solve_quadratic_program(problem, VectorXd::Zero(2));
  EXPECT_TRUE(found.solved);
  EXPECT_NEAR(found.x(0), 1.2, 1e-7);
  EXPECT_NEAR(found.x(1), 0.8, 1e-7);
  // Gradient = -A' multipliers.
  const VectorXd balance =
      times(problem.q, found.x) + problem.c + transpose_times(problem.a, found.multiplier);
  EXPECT_LT(balance.norm(), 1e-6);
}

TEST(QuadraticProgram, ALinearProgramEndsInItsCorner) {
  QuadraticProgram problem;
  problem.q = MatrixXd::Zero(2, 2);
  problem.c = (VectorXd(2) << -1.0, -1.0).finished();
  problem.a = (MatrixXd(4, 2) << 2.0, 1.0, 1.0, 2.0, -1.0, 0.0, 0.0, -1.0).finished();
  problem.b = (VectorXd(4) << 3.0, 3.0, 0.0, 0.0).finished();
  const auto found = solve_quadratic_program(problem, VectorXd::Zero(2));
  EXPECT_NEAR(found.x(0), 1.0, 1e-6);
  EXPECT_NEAR(found.x(1), 1.0, 1e-6);
}

TEST(BoundedLeastSquares, SatisfiesKuhnAndTuckerAndReducesToTheFreeSolution) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    LongMatrix a(9, LongVector(4));
    LongVector b(9);
    for (auto& row : a)
      for (auto& v : row) v = random.normal();
    for (auto& v : b) v = random.normal();
    const BoundedSolution tight = bounded_least_squares(a, b, -0.1L, 0.1L);
    EXPECT_LT(static_cast<double>(tight.optimality_residual), 1e-15);
    for (const long double v : tight.x) EXPECT_LE(std::abs(static_cast<double>(v)), 0.1 + 1e-18);
    const BoundedSolution positive =
        bounded_least_squares(a, b, 0.0L, std::numeric_limits<long double>::infinity());
    EXPECT_LT(static_cast<double>(positive.optimality_residual), 1e-15);
    for (const long double v : positive.x) EXPECT_GE(v, 0.0L);
    const BoundedSolution wide = bounded_least_squares(a, b, -1e3L, 1e3L);
    const LongVector free = least_squares(a, b);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(static_cast<double>(wide.x[i]), static_cast<double>(free[i]),
                  1e-15 * 1e3);  // steps come from the bounds
      EXPECT_EQ(wide.bound[i], 0);
    }
  }
}

/// The line of least squares through four points, by its own formulas; the matrix that makes it of them; singular values of
/// orthogonal columns are their lengths.
TEST(LeastSquaresOfFew, AreTheNormalEquationsSolution) {
  const LongMatrix a = {{1, -3}, {1, -1}, {1, 1}, {1, 3}};
  const LongVector y = {2.0L, 1.0L, 4.0L, 5.0L};
  const LongVector line = least_squares(a, y);
  EXPECT_NEAR(static_cast<double>(line[0]), 3.0, 1e-17);
  EXPECT_NEAR(static_cast<double>(line[1]), (-6.0 - 1.0 + 4.0 + 15.0) / 20.0, 1e-17);
  const LongMatrix inverse = least_squares_inverse(a);
  ASSERT_EQ(inverse.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    long double sum = 0.0L;
    for (std::size_t k = 0; k < 4; ++k) sum += inverse[i][k] * y[k];
    EXPECT_NEAR(static_cast<double>(sum), static_cast<double>(line[i]), 1e-16);
  }
  EXPECT_NEAR(condition_number(a), std::sqrt(20.0) / 2.0, 1e-12);
  EXPECT_GT(condition_number({{1, 2}, {2, 4}}), 1e15);
}

TEST(ParallelFor, DoesEachPieceOnceAndThrowsAgain) {
  for (const int threads : {0, 1, 3, 50}) {
    std::vector<std::atomic<int>> done(17);
    parallel_for(done.size(), threads, [&](std::size_t i) { ++done[i]; });
    for (const auto& d : done) EXPECT_EQ(d, 1);
  }
  EXPECT_THROW(parallel_for(8, 2,
                            [](std::size_t i) {
                              if (i == 5) throw std::runtime_error("five");
                            }),
               std::runtime_error);
  EXPECT_GE(thread_count(0), 1);
  EXPECT_EQ(thread_count(3), 3);
}

}  // namespace
}  // namespace bodesmith
