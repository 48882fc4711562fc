#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hysteresis/fractional_dynamic.hpp"
#include "hysteresis/grunwald_letnikov.hpp"
#include "hysteresis/model_type.hpp"
#include "lti/fractional_transfer.hpp"
#include "numeric/optimisation/population_search.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

/// 003, Table 1.
FractionalDynamic table_1() {
  FractionalDynamic out;
  out.k_m = 1.71e8;
  out.xi = 0.031;
  out.omega_n = 1.28e4;
  out.tau = 4.18e-4;
  out.eta = 0.756;
  out.lambda = 0.811;
  out.k_p = 0.192;
  out.theta = 5.923;
  out.chi = 6.897;
  out.rho = -0.140;
  out.delta = 0.072;
  return out;
}

TEST(Fractional, SectionsAreTheFractionalPart) {
  const FractionalDynamic model = table_1();
  const LagSpread spread = LagSpread::of(model, 1.0 / model.tau);
  for (double w = 1e-2; w < 1e5; w *= 2.1) {
    const std::complex<double> s(0.0, w);
    EXPECT_LT(std::abs(spread.response(s) / model.fractional_part(s) - 1.0), 2e-4) << w;
  }
  FractionalDynamic finer = model;
  finer.modes = 150;
  const LagSpread fine = LagSpread::of(finer, 1.0 / model.tau);
  for (double w = 1e-1; w < 2e4; w *= 2.1) {
    const std::complex<double> s(0.0, w);
    EXPECT_LT(std::abs(fine.response(s) / model.fractional_part(s) - 1.0), 5e-5) << w;
  }
}

/// A step into 1/(1 + s^½) answers with 1 − e^t erfc(√t) (Mittag-Leffler).
TEST(Fractional, StepIsMittagLeffler) {
  FractionalDynamic model;
  model.k_p = 1.0;
  model.theta = 0.0;
  model.chi = 1.0;
  model.lambda = 0.5;
  model.tau = 1e-5;
  model.omega_n = 1e5;
  model.xi = 0.7;
  model.k_m = 1e10;
  model.modes = 120;
  FractionalOperator op(model);
  op.reset(0.0);
  // A ramp over 1 µs is a step for what follows.
  double t = 1e-6;
  op.step(1.0, 1e-6);
  for (int i = 0; i < 200; ++i) {
    t += 0.01;
    const double y = op.step(1.0, 0.01);
    EXPECT_NEAR(y, 1.0 - std::exp(t) * std::erfc(std::sqrt(t)), 3e-4) << t;
  }
}

TEST(Fractional, SectionsAgreeWithGrunwaldLetnikovAndTheFrequencyResponse) {
  FractionalDynamic model = table_1();
  const double step_s = 1e-4;
  std::vector<double> u;
  for (int i = 0; i < 600; ++i) u.push_back(2.0 - 2.0 * std::cos(2 * std::numbers::pi * 60.0 * i * step_s));
  FractionalOperator op(model);
  std::vector<double> sections{op.reset(0.0)};
  for (std::size_t i = 1; i < u.size(); ++i) sections.push_back(op.step(u[i], step_s));
  double before = 1e9;
  for (const int refine : {1, 4, 16}) {
    const std::vector<double> gl = simulate_grunwald_letnikov(model, u, step_s, refine);
    double worst = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) worst = std::max(worst, std::abs(gl[i] - sections[i]));
    EXPECT_LT(worst, 0.6 * before) << refine;  // first order: it falls with the step
    before = worst;
  }
  EXPECT_LT(before, 0.01);
  // Steady state at one frequency against P(jw).
  model.rho = model.delta = 0.0;
  FractionalOperator again(model);
  again.reset(0.0);
  const double w = 2 * std::numbers::pi * 100.0;
  std::complex<double> sum = 0.0;
  const int period = 400;
  for (int i = 1; i <= 60 * period; ++i) {
    const double y = again.step(std::sin(w * i * 0.01 / period), 0.01 / period);
    if (i > 50 * period) sum += y * std::polar(1.0, -w * i * 0.01 / period);
  }
  sum *= 2.0 / (10.0 * period) * std::complex<double>(0.0, 1.0);
  EXPECT_LT(std::abs(sum / model.response({0.0, w}) - 1.0), 1e-3);
}

/// Whatever the orders and wherever the corners: as exact from a ten-thousandth of the lag's and the resonance's corners up to
/// them. Parameters are drawn.
TEST(Fractional, SectionsAreTheFractionalPartOfDrawnModels) {
  const auto drawn = [](int i, int k, double low, double high) {
    return low + (high - low) * std::fmod(0.5 + i * std::sqrt(2.0 + 3.0 * k), 1.0);
  };
  for (int i = 0; i < 60; ++i) {
    FractionalDynamic model = table_1();
    model.k_p = 1.0;
    model.eta = drawn(i, 0, 0.1, 0.9);
    model.lambda = drawn(i, 1, 0.1, 0.9);
    model.theta = std::pow(10.0, drawn(i, 2, -5.0, 0.0));
    model.chi = std::pow(10.0, drawn(i, 3, -5.0, 0.0));
    const LagSpread spread = LagSpread::of(model, 1.0 / model.tau);
    for (double w = 1e-4 / model.tau; w < model.omega_n; w *= 2.1) {
      const std::complex<double> s(0.0, w);
      EXPECT_LT(std::abs(spread.response(s) / model.fractional_part(s) - 1.0), 1e-3) << i << " at " << w;
    }
  }
}

/// At rest the output is the static gain's, and stays; an input that jumps is one that moves within next to no time.
TEST(Fractional, RestsAndJumps) {
  FractionalDynamic model = table_1();
  model.rho = 0.0;
  FractionalOperator op(model);
  const double rest = model.static_gain() * 0.7 + model.delta;
  EXPECT_NEAR(op.reset(0.7), rest, 1e-12);
  for (int i = 0; i < 50; ++i) EXPECT_NEAR(op.step(0.7, 1e-3), rest, 1e-9);
  FractionalOperator moved(model);
  op.reset(0.0);
  moved.reset(0.0);
  op.step(1.0, 0.0);
  moved.step(1.0, 1e-9);
  for (int i = 0; i < 50; ++i) EXPECT_NEAR(op.step(1.0, 1e-4), moved.step(1.0, 1e-4), 1e-5);
}

/// No time, no change; peek() is what step() will say at any step, rho t and delta in it.
TEST(Fractional, PeeksAreStepsAtAnyStepAndNoTimeChangesNothing) {
  FractionalDynamic model = table_1();
  model.rho = -0.14;
  model.delta = 0.072;
  FractionalOperator op(model);
  op.reset(0.2);
  double y = 0.0;
  for (const double dt : {1e-3, 1e-3, 2e-3, 5e-4, 5e-4, 1e-2}) {
    const double u = 0.3 + 20.0 * dt;
    const double ahead = op.peek(u, dt);
    y = op.step(u, dt);
    EXPECT_EQ(ahead, y) << dt;
    EXPECT_EQ(op.step(0.9, 0.0), y) << dt;
    EXPECT_EQ(op.peek(0.9, 0.0), y) << dt;
  }
}

TEST(Fractional, Equation20AgainstTheFullDenominator) {
  const FractionalPolynomial full = table_1().denominator();
  ASSERT_EQ(full.size(), 8u);
  const double printed[] = {0.00289, 0.000418, 9.219, 1.337, 481282.557, 69779.6};
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(full[static_cast<std::size_t>(i)].coefficient / printed[i], 1.0, 0.01) << i;
  // The last printed one belongs to s¹, and two more terms are needed.
  EXPECT_DOUBLE_EQ(full[5].power, 1.0);
  EXPECT_DOUBLE_EQ(full[6].power, 0.811);
  EXPECT_NEAR(full[6].coefficient, 6.897 * 1.28e4 * 1.28e4, 1.0);
  EXPECT_NEAR(full[7].coefficient, 1.28e4 * 1.28e4, 1.0);
  EXPECT_TRUE(fractional_stability(full).stable());
}

TEST(Fractional, ArgumentPrincipleAgreesWithMatignon) {
  testing::Random random(8);
  int unstable = 0;
  for (int trial = 0; trial < 60; ++trial) {
    FractionalPolynomial p;
    for (int k = 0; k <= 12; ++k)
      if (k == 0 || k == 12 || random.uniform() < 0.4)
        p.push_back(
            {std::exp(2.0 * random.normal()) * (k > 0 && k < 12 && random.uniform() < 0.3 ? -1.0 : 1.0),
             0.25 * k});
    const FractionalStability found = fractional_stability(p);
    EXPECT_EQ(found.unstable_poles, found.matignon_count) << trial;
    unstable += !found.stable();
  }
  EXPECT_GT(unstable, 10);
  // Table 1 with orders rounded to q = 0.05.
  FractionalDynamic rounded = table_1();
  rounded.lambda = 0.8;
  EXPECT_EQ(fractional_stability(rounded.denominator()).matignon_count, 0);
}

TEST(Fractional, DifferentialEvolutionFindsRosenbrocksValley) {
  const auto cost = [](const Eigen::VectorXd& x) {
    double sum = 0.0;
    for (Eigen::Index i = 0; i + 1 < x.size(); ++i)
      sum += 100 * std::pow(x(i + 1) - x(i) * x(i), 2) + std::pow(1 - x(i), 2);
    return sum;
  };
  DifferentialEvolutionOptions options;
  options.generations = 1500;
  options.spread = 0.0;
  const auto found = differential_evolution(cost, Eigen::VectorXd::Constant(4, -3.0),
                                            Eigen::VectorXd::Constant(4, 3.0), options);
  EXPECT_LT(found.cost, 1e-10);
  const auto again = differential_evolution(cost, Eigen::VectorXd::Constant(4, -3.0),
                                            Eigen::VectorXd::Constant(4, 3.0), options);
  EXPECT_EQ(found.x, again.x);
}

TEST(Fractional, IdentificationFollowsItsOwnRecord) {
  FractionalDynamic model = table_1();
  FractionalOperator op(model);
  std::vector<double> u, y;
  for (int i = 0; i < 2500; ++i) {
    const double t = i * 1e-4;
    u.push_back(3.0 + 1.5 * std::sin(2 * std::numbers::pi * 20 * t) +
                0.8 * std::sin(2 * std::numbers::pi * 90 * t + 1.0) +
                0.3 * std::sin(2 * std::numbers::pi * 310 * t));
    y.push_back(i == 0 ? op.reset(u[0]) : op.step(u.back(), 1e-4));
  }
  const TimeRecord record = testing::record(u, y, 1e-4);
  IdentifyOptions options;
  options.effort = 0.3;
  const Identified found = model_type_registry().get("fractional_dynamic").identify({&record, 1}, options);
  EXPECT_LT(testing::errors_of(found, {&record, 1}).rms_percent, 0.5);
}

TEST(Fractional, InverseOfTheForceTracksSlowReferences) {
  Parameters values;
  values.set("K_M", 1.71e8)
      .set("xi", 0.5)
      .set("omega_n", 1.28e4)
      .set("tau", 1e-5)
      .set("eta", 0.756)
      .set("lambda", 0.811);
  values.set("K_p", 0.192).set("Theta", 5.923).set("chi", 6.897);
  for (const double rho : {0.0, -2.0}) {  // whose drift is taken out as it grows
    const Model model = make_model("fractional_dynamic", values.set("rho", rho));
    const auto inverse = make_inverse(model);
    inverse->reset(0.5);
    double worst = 0.0;
    for (int i = 1; i < 3000; ++i) {
      const double r = 0.5 + 0.3 * std::sin(2 * std::numbers::pi * 10.0 * i * 1e-4);
      inverse->step(r, 1e-4);
      worst = std::max(worst, std::abs(inverse->achieved() - r));
    }
    EXPECT_LT(worst, 0.006) << rho;  // the lag of 10 us and 2 xi/omega at 10 Hz make 0.3 %
  }
}

}  // namespace
}  // namespace bodesmith::hysteresis
