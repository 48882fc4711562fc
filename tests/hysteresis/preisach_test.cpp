#include "hysteresis/preisach.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "brute_force.hpp"
#include "hysteresis/everett_trace.hpp"
#include "hysteresis/identification/preisach_identify.hpp"
#include "hysteresis/model_type.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

using testing::Random;

std::vector<double> random_weights(std::size_t levels, std::uint64_t seed, double zeros = 0.3) {
  Random random(seed);
  std::vector<double> w(levels * (levels + 1) / 2);
  for (double& value : w)
    value = random.uniform() < zeros ? 0.0 : random.uniform() / static_cast<double>(w.size());
  return w;
}

Model preisach_model(std::size_t levels, std::uint64_t seed, const char* interpolation = "bilinear") {
  Parameters values;
  values.set("u_min", -1.0).set("u_max", 3.0).set("w", random_weights(levels, seed)).set("offset", 0.25);
  values.set("interpolation", interpolation);
  return make_model("preisach", values);
}

TEST(Preisach, StackEqualsAllRelaysByBruteForce) {
  for (const std::size_t levels : {1u, 2u, 7u, 60u}) {
    const auto stack = make_operator(preisach_model(levels, levels, "relays"));
    testing::BruteForceRelays all(-1.0, 3.0, levels, random_weights(levels, levels), 0.25);
    Random random(levels + 100);
    ASSERT_NEAR(stack->reset(0.4), all.reset(0.4), 1e-12);
    double u = 0.4;
    for (int i = 0; i < 20000; ++i) {
      // Long swings, small wiggles, exact nodes, outside the range.
      const double kind = random.uniform();
      if (kind < 0.3)
        u = -1.5 + 5.0 * random.uniform();
      else if (kind < 0.8)
        u += 0.1 * (random.uniform() - 0.5);
      else
        u = -1.0 + 4.0 * std::floor(random.uniform() * static_cast<double>(levels + 1)) /
                       static_cast<double>(levels);
      ASSERT_NEAR(stack->step(u, 1.0), all.step(u), 1e-12) << levels << " " << i;
    }
  }
}

TEST(Preisach, BilinearAgreesWithTheRelaysAtTheNodes) {
  const std::size_t levels = 64;  // nodes are exact doubles
  const auto smooth = make_operator(preisach_model(levels, 3));
  testing::BruteForceRelays all(-1.0, 3.0, levels, random_weights(levels, 3), 0.25);
  Random random(9);
  smooth->reset(-1.0);
  all.reset(-1.0);
  for (int i = 0; i < 5000; ++i) {
    const double u = -1.0 + 4.0 * std::floor(random.uniform() * (levels + 1)) / levels;
    ASSERT_NEAR(smooth->step(u, 1.0), all.step(u), 1e-12) << i;
  }
}

TEST(Preisach, PeekIsStepWithoutTheStep) {
  const auto op = make_operator(preisach_model(30, 5));
  Random random(4);
  op->reset(0.0);
  double u = 0.0;
  for (int i = 0; i < 20000; ++i) {
    u = random.uniform() < 0.5 ? -1.2 + 4.4 * random.uniform() : u + 0.2 * (random.uniform() - 0.5);
    const double expected = op->peek(u, 1.0);
    ASSERT_NEAR(op->step(u, 1.0), expected, 1e-13) << i;
  }
}

TEST(Preisach, InverseIsExact) {
  for (const double zeros : {0.0, 0.3, 0.97}) {
    Parameters values;
    values.set("u_min", 0.0).set("u_max", 1.0).set("w", random_weights(200, 17, zeros));
    const Model model = make_model("preisach", values);
    const auto forward = make_operator(model);
    const auto inverse = make_inverse(model);
    const double top = forward->step(1.0, 1.0);
    Random random(21);
    double wanted = 0.3 * top;
    ASSERT_NEAR(forward->reset(inverse->reset(wanted)), wanted, 1e-12);
    for (int i = 0; i < 20000; ++i) {
      wanted = random.uniform() < 0.3
                   ? top * random.uniform()
                   : std::min(std::max(wanted + 0.02 * top * (random.uniform() - 0.5), 0.0), top);
      const double u = inverse->step(wanted, 1.0);
      ASSERT_GE(u, 0.0);
      ASSERT_LE(u, 1.0);
      ASSERT_NEAR(forward->step(u, 1.0), wanted, 1e-12) << zeros << " " << i;
      ASSERT_NEAR(inverse->achieved(), wanted, 1e-12);
    }
    inverse->step(2.0 * top, 1.0);
    EXPECT_NEAR(inverse->achieved(), top, 1e-12);
    EXPECT_DOUBLE_EQ(inverse->step(-1.0, 1.0), 0.0);
  }
}

TEST(Preisach, TraceIsTheOperatorAndItsAdjointIsTransposed) {
  for (const bool bilinear : {true, false}) {
    const std::size_t levels = 24;
    Random random(31);
    std::vector<double> u = testing::random_walk(random, -1.0, 3.0, 60, 13);
    u[100] = u[101];  // a pause
    u[200] = -1.3;    // below the range
    const TimeRecord record = testing::record(u, u);
    EverettTrace trace(-1.0, 3.0, levels, bilinear ? CellShape::bilinear : CellShape::relays);
    trace.add(record, 5);
    trace.add(record, 0);
    const auto count = static_cast<std::size_t>(trace.rows());
    ASSERT_EQ(count, 2 * u.size() - 5);
    const std::vector<double> w = random_weights(levels, 8);
    const Eigen::VectorXd weights =
        Eigen::Map<const Eigen::VectorXd>(w.data(), static_cast<Eigen::Index>(w.size()));
    Eigen::VectorXd y;
    trace.apply(weights, y);
    const auto op = make_operator(preisach_model(levels, 8, bilinear ? "bilinear" : "relays"));
    std::vector<double> direct;
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t i = 0; i < u.size(); ++i) {
        const double value = i == 0 ? op->reset(u[0]) : op->step(u[i], 1.0);
        if (pass == 1 || i >= 5) direct.push_back(value - 0.25);
      }
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_NEAR(y(static_cast<Eigen::Index>(i)), direct[i], 1e-12) << i;
    Eigen::VectorXd r(trace.rows()), g, again;
    for (Eigen::Index i = 0; i < r.size(); ++i) r(i) = random.normal();
    trace.adjoint(r, g);
    EXPECT_NEAR(r.dot(y), g.dot(weights), 1e-9 * std::abs(r.dot(y)) + 1e-12);
    trace.apply(weights, again);
    EXPECT_LT((again - y).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Preisach, IdentificationPredictsUnseenMotion) {
  const std::size_t levels = 40;
  // A smooth density.
  std::vector<double> w;
  for (std::size_t i = 0; i < levels; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      w.push_back(std::exp(-0.002 * static_cast<double>((i - j) * (i - j))) *
                  (1.0 + 0.01 * static_cast<double>(i)) / 500.0);
  Parameters values;
  values.set("u_min", 0.0).set("u_max", 1.0).set("w", w).set("offset", -2.0);
  const auto op = make_operator(make_model("preisach", values));
  const auto run = [&](const std::vector<double>& u, double noise, Random& random) {
    std::vector<double> y;
    for (std::size_t i = 0; i < u.size(); ++i)
      y.push_back((i == 0 ? op->reset(u[0]) : op->step(u[i], 1.0)) + noise * random.normal());
    return testing::record(u, y);
  };
  Random random(1);
  const TimeRecord train = run(testing::modulated_triangle(8000, 0.0, 1.0, 100), 1e-3, random);
  const TimeRecord test = run(testing::random_walk(random, 0.0, 1.0, 40, 30), 0.0, random);
  IdentifyOptions options;
  options.size = static_cast<int>(levels);
  const Identified found = model_type_registry().get("preisach").identify({&train, 1}, options);
  EXPECT_LT(testing::errors_of(found, {&train, 1}).rms, 1.1e-3);
  EXPECT_LT(testing::errors_of(found, {&test, 1}).rms_percent, 1.0);
  EXPECT_TRUE(found.converged);
}

TEST(Preisach, RefusesWrongCountsAndNegativeWeights) {
  Parameters values;
  values.set("u_min", 0.0).set("u_max", 1.0).set("w", std::vector<double>(4, 1.0));
  EXPECT_THROW(make_model("preisach", values), DesignError);
  values.set("w", std::vector<double>{1.0, -1.0, 1.0});
  EXPECT_THROW(make_model("preisach", values), DesignError);
  values.set("w", std::vector<double>{1.0}).set("u_max", 0.0);
  EXPECT_THROW(make_model("preisach", values), DesignError);
}

}  // namespace
}  // namespace bodesmith::hysteresis
