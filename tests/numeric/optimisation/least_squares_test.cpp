#include "numeric/optimisation/least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "numeric/random.hpp"

namespace bodesmith {
namespace {

TEST(Termination, OnlyAMinimumCountsAsConverged) {
  EXPECT_TRUE(converged(Termination::gradient));
  EXPECT_TRUE(converged(Termination::step));
  EXPECT_TRUE(converged(Termination::cost));
  EXPECT_FALSE(converged(Termination::max_iterations));
  EXPECT_FALSE(converged(Termination::stopped));
  EXPECT_FALSE(converged(Termination::not_runnable));
}

}  // namespace

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Samples of a exp(-k t) + c, a = 2, k = 3, c = 0.5, and the residuals of a guess.
struct Decay {
  int runs = 0;
  double noise = 0.0;
  bool operator()(const VectorXd& x, VectorXd& r) {
    ++runs;
    Random random(4);
    r.resize(40);
    for (Eigen::Index i = 0; i < 40; ++i) {
      const double t = 0.05 * static_cast<double>(i);
      const double measured = 2.0 * std::exp(-3.0 * t) + 0.5 + noise * random.normal();
      r(i) = x(0) * std::exp(-x(1) * t) + x(2) - measured;
    }
    return true;
  }
};

const std::vector<SearchVariable> kDecayStart = {
    {.value = 1.0}, {.value = 0.4, .min = 1e-3, .max = 1e3, .logarithmic = true}, {.value = 0.0}};

TEST(LeastSquares, FindsAnExponentialToRounding) {
  for (const bool broyden : {true, false}) {
    Decay decay;
    LeastSquaresOptions options;
    options.broyden = broyden;
    options.max_iterations = 100;
    const auto fit = least_squares(kDecayStart, std::ref(decay), options);
    EXPECT_TRUE(converged(fit.termination));
    EXPECT_NEAR(fit.values(0), 2.0, 1e-6);
    EXPECT_NEAR(fit.values(1), 3.0, 1e-6);
    EXPECT_NEAR(fit.values(2), 0.5, 1e-6);
    EXPECT_EQ(fit.runs, decay.runs);
    EXPECT_DOUBLE_EQ(fit.cost, fit.residuals.squaredNorm());
  }
}

TEST(LeastSquares, DeviationsAreThoseOfTheLinearTheory) {
  Decay decay;
  decay.noise = 0.01;
  const auto fit = least_squares(kDecayStart, std::ref(decay), {.cost_tolerance = 1e-12});
  MatrixXd jacobian(40, 3);
  for (Eigen::Index i = 0; i < 40; ++i) {
    const double t = 0.05 * static_cast<double>(i);
    const double e = std::exp(-fit.values(1) * t);
    jacobian.row(i) << e, -fit.values(0) * t * e, 1.0;
  }
  const MatrixXd covariance = inverse(gram(jacobian)) * fit.cost / 37.0;
  for (Eigen::Index j = 0; j < 3; ++j)
    EXPECT_NEAR(fit.deviation(j) / std::sqrt(covariance(j, j)), 1.0, 0.01) << j;
  EXPECT_NEAR((fit.gram - gram(jacobian)).norm() / fit.gram.norm(), 0.0, 0.01);
}

TEST(LeastSquares, RosenbrocksValley) {
  const auto residuals = [](const VectorXd& x, VectorXd& r) {
    r.resize(2);
    r << 10.0 * (x(1) - x(0) * x(0)), 1.0 - x(0);
    return true;
  };
  LeastSquaresOptions options;
  options.max_iterations = 200;
  options.cost_tolerance = 1e-14;
  for (const bool analytic : {false, true}) {
    if (analytic) {
      options.jacobian = [](const VectorXd& x, MatrixXd& j) {
        j.resize(2, 2);
        j << -20.0 * x(0), 10.0, -1.0, 0.0;
      };
    }
    const auto fit = least_squares({{.value = -1.2}, {.value = 1.0}}, residuals, options);
    EXPECT_NEAR(fit.values(0), 1.0, 1e-5);
    EXPECT_NEAR(fit.values(1), 1.0, 1e-5);
  }
}

TEST(LeastSquares, UnknownsRestAtTheirBoundsAndTheOthersAreBestThere) {
  // min 9 (x + y - 3)^2 + (x - y + 1)^2 with y <= 1: free (1, 2); at y = 1 the derivative by x is 0 at x = 1.8.
  const auto residuals = [](const VectorXd& v, VectorXd& r) {
    r.resize(2);
    r << 3.0 * (v(0) + v(1) - 3.0), v(0) - v(1) + 1.0;
    return true;
  };
  const auto fit = least_squares({{.value = 0.0}, {.value = 0.0, .min = -1.0, .max = 1.0}}, residuals,
                                 {.max_iterations = 6, .cost_tolerance = 1e-14});
  EXPECT_NEAR(fit.values(0), 1.8, 1e-5);  // linear: at once, but for the damping
  EXPECT_DOUBLE_EQ(fit.values(1), 1.0);
}

TEST(LeastSquares, SaysWhyItEnded) {
  const auto never = [](const VectorXd&, VectorXd&) { return false; };
  const auto nowhere = least_squares({{.value = 1.0}}, never);
  EXPECT_EQ(nowhere.termination, Termination::not_runnable);
  EXPECT_EQ(nowhere.runs, 0);
  EXPECT_EQ(nowhere.residuals.size(), 0);
  Decay decay;
  EXPECT_EQ(least_squares(kDecayStart, std::ref(decay), {.max_iterations = 1}).termination,
            Termination::max_iterations);
  EXPECT_EQ(least_squares(kDecayStart, std::ref(decay), {.stop = [] { return true; }}).termination,
            Termination::stopped);
  EXPECT_EQ(least_squares({},
                          [](const VectorXd&, VectorXd& r) {
                            r = VectorXd::Ones(3);
                            return true;
                          })
                .termination,
            Termination::gradient);
}

TEST(LeastSquares, GoesAroundWhereTheModelCannotBeRun) {
  // ln x below 0 cannot be run; the minimum is at e.
  const auto residuals = [](const VectorXd& x, VectorXd& r) {
    if (!(x(0) > 0.0)) return false;
    r = VectorXd::Constant(1, std::log(x(0)) - 1.0);
    return true;
  };
  const auto fit = least_squares({{.value = 40.0}}, residuals, {.max_iterations = 60});
  EXPECT_NEAR(fit.values(0), std::exp(1.0), 1e-3);
}

TEST(LeastSquares, BroydenSavesRunsOfTheModel) {
  // Many unknowns: a Jacobian is expensive.
  int runs = 0;
  const auto residuals = [&](const VectorXd& x, VectorXd& r) {
    ++runs;
    r.resize(60);
    for (Eigen::Index i = 0; i < 60; ++i) {
      const double t = static_cast<double>(i) / 59.0;
      double sum = -std::sin(3.0 * t);
      double power = 1.0;
      for (Eigen::Index k = 0; k < x.size(); ++k, power *= t) sum += std::atan(x(k)) * power;
      r(i) = sum;
    }
    return true;
  };
  const std::vector<SearchVariable> start(6, {.value = 0.1});
  const auto with = least_squares(start, residuals, {.max_iterations = 100});
  const auto without = least_squares(start, residuals, {.max_iterations = 100, .broyden = false});
  EXPECT_LT(with.runs, without.runs);
  EXPECT_LT(with.cost, 1.01 * without.cost + 1e-8);
}

/// On its way to 10 by ones, the sum of squares falling by a fifth and more, two steps of three need no derivatives.
TEST(LeastSquares, AJacobianIsKeptThroughTwoUpdates) {
  const auto residuals = [](const VectorXd& x, VectorXd& r) {
    r = VectorXd::Constant(1, x(0) - 10.0);
    return true;
  };
  for (const bool broyden : {true, false}) {
    int asked = 0;
    const auto jacobian = [&](const VectorXd&, MatrixXd& j) {
      j = MatrixXd::Ones(1, 1);
      ++asked;
    };
    const auto fit =
        least_squares({{.value = 0.0}}, residuals,
                      {.max_iterations = 9, .jacobian = jacobian, .broyden = broyden, .max_step = 1.0});
    EXPECT_DOUBLE_EQ(fit.values(0), 9.0);
    EXPECT_EQ(asked, broyden ? 3 : 9);
  }
}

TEST(LeastSquares, SensitivitiesAreDerivativesInSearchCoordinates) {
  Decay decay;
  const VectorXd at = (VectorXd(3) << 2.0, 3.0, 0.5).finished();
  const auto columns = sensitivities(kDecayStart, std::ref(decay), at);
  ASSERT_EQ(columns.size(), 3U);
  for (Eigen::Index i = 0; i < 40; ++i) {
    const double t = 0.05 * static_cast<double>(i);
    EXPECT_NEAR(columns[0](i), std::exp(-3.0 * t), 1e-9);
    EXPECT_NEAR(columns[1](i), -2.0 * t * std::exp(-3.0 * t) * 3.0, 1e-3);  // by ln k
    EXPECT_NEAR(columns[2](i), 1.0, 1e-9);
  }
}

TEST(ParameterDeviation, ACorrelatedResidualCountsAsFewerSamples) {
  const MatrixXd gram = MatrixXd::Identity(1, 1) * 1000.0;
  VectorXd white(1000), slow(1000);
  Random random(2);
  double state = 0.0;
  for (Eigen::Index i = 0; i < 1000; ++i) {
    white(i) = random.normal();
    state = 0.9 * state + std::sqrt(1.0 - 0.81) * random.normal();
    slow(i) = state;
  }
  EXPECT_NEAR(parameter_deviation(gram, white)(0), 1.0 / std::sqrt(1000.0), 0.1 / std::sqrt(1000.0));
  // (1 + 0.9)/(1 - 0.9) = 19 times the variance.
  EXPECT_NEAR(parameter_deviation(gram, slow)(0), std::sqrt(19.0 / 1000.0), 0.3 * std::sqrt(19.0 / 1000.0));
  EXPECT_TRUE(std::isinf(parameter_deviation(MatrixXd::Zero(1, 1), white)(0)));
  // Two that do the same are not known apart, one beside them is; as few samples as unknowns say nothing.
  MatrixXd same = 1000.0 * MatrixXd::Identity(3, 3);
  same(0, 1) = same(1, 0) = 1000.0;
  const VectorXd deviation = parameter_deviation(same, white);
  EXPECT_TRUE(std::isinf(deviation(0)) && std::isinf(deviation(1)));
  EXPECT_NEAR(deviation(2), 1.0 / std::sqrt(1000.0), 0.1 / std::sqrt(1000.0));
  EXPECT_TRUE(std::isinf(parameter_deviation(gram, white.head(2))(0)));
  EXPECT_TRUE(std::isfinite(parameter_deviation(gram, white.head(3))(0)));
}

TEST(LeastSquares, ComesToTheSameBitsOnAnyNumberOfThreads) {
  const Residuals residuals = [](const VectorXd& x, VectorXd& r) {
    Decay decay;
    decay.noise = 0.01;
    return decay(x, r);
  };
  LeastSquaresOptions options;
  const LeastSquaresResult one = least_squares(kDecayStart, residuals, options);
  options.threads = 3;
  const LeastSquaresResult three = least_squares(kDecayStart, residuals, options);
  EXPECT_EQ(one.runs, three.runs);
  EXPECT_EQ(one.values, three.values);
  EXPECT_EQ(one.residuals, three.residuals);
  EXPECT_EQ(one.deviation, three.deviation);
  const auto alone = sensitivities(kDecayStart, residuals, one.values);
  const auto together = sensitivities(kDecayStart, residuals, one.values, 3);
  ASSERT_EQ(alone.size(), together.size());
  for (std::size_t k = 0; k < alone.size(); ++k) EXPECT_EQ(alone[k], together[k]);
}

}  // namespace

}  // namespace bodesmith
