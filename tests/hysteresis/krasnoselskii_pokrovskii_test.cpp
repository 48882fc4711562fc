#include "hysteresis/krasnoselskii_pokrovskii.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brute_force.hpp"
#include "hysteresis/model_type.hpp"
#include "test_signals.hpp"

namespace bodesmith::hysteresis {
namespace {

using testing::Random;

std::vector<double> densities(std::size_t levels, std::uint64_t seed, double zeros) {
  Random random(seed);
  std::vector<double> mu(levels * (levels + 1) / 2);
  for (double& value : mu)
    value = random.uniform() < zeros ? 0.0 : random.uniform() / static_cast<double>(mu.size());
  return mu;
}

Model kp_model(std::size_t levels, std::uint64_t seed, double a1 = 1.0, double a2 = 0.0) {
  Parameters values;
  values.set("u_min", 0.0).set("u_max", 120.0).set("mu", densities(levels, seed, 0.3)).set("offset", 0.1);
  values.set("a1", a1).set("a2", a2);
  return make_model("krasnoselskii_pokrovskii", values);
}

TEST(KrasnoselskiiPokrovskii, StackEqualsEveryKernelAsPrinted) {
  for (const std::size_t levels : {1u, 2u, 9u, 40u}) {
    const auto stack = make_operator(kp_model(levels, levels));
    testing::BruteForceKp all(0.0, 120.0, levels, densities(levels, levels, 0.3));
    Random random(levels);
    double u = 30.0;
    ASSERT_NEAR(stack->reset(u), 0.1 + all.reset(u), 1e-12);
    for (int i = 0; i < 10000; ++i) {
      u = random.uniform() < 0.3 ? -5.0 + 130.0 * random.uniform() : u + 4.0 * (random.uniform() - 0.5);
      ASSERT_NEAR(stack->step(u, 1.0), 0.1 + all.step(u), 1e-11) << levels << " " << i;
    }
  }
}

TEST(KrasnoselskiiPokrovskii, ExactInverseAndRecursiveInverse) {
  const Model model = kp_model(100, 4);
  const auto forward = make_operator(model);
  const auto inverse = make_inverse(model);
  const double top = forward->step(120.0, 1.0) - 0.1;
  Random random(12);
  double wanted = 0.1 + 0.5 * top;
  ASSERT_NEAR(forward->reset(inverse->reset(wanted)), wanted, 1e-12);
  for (int i = 0; i < 10000; ++i) {
    wanted = 0.1 + top * random.uniform();
    ASSERT_NEAR(forward->step(inverse->step(wanted, 1.0), 1.0), wanted, 1e-12) << i;
  }
  // Eq. 13, 14: the miss shrinks with the step.
  double before = 1e9;
  for (const double delta_u : {10.0, 1.0, 0.1}) {
    RecursiveInverse recursive(make_operator(model), delta_u, 0.0, 120.0);
    recursive.reset(0.1);
    double worst = 0.0;
    for (int i = 0; i <= 100; ++i) {
      const double r = 0.1 + top * (0.5 - 0.45 * std::cos(0.15 * i));
      recursive.step(r, 1.0);
      if (i > 2) worst = std::max(worst, std::abs(recursive.achieved() - r));
    }
    EXPECT_LT(worst, before);
    before = worst;
  }
  EXPECT_LT(before, 1e-3 * top);
}

/// Between two turning points at whose side nothing moves for cells: an output beyond the turn that the input heads for, by rounding alone,
/// is not looked for at the far end of those.
template <class Rule>
void expect_no_way_past_the_turn(const std::shared_ptr<const EverettTable>& table) {
  const Rule rule(table);
  const auto turn_at = [&](double u, double y) { return typename Rule::Turn{u, y, rule.cache(u)}; };
  const auto bottom = turn_at(0.0, 0.0);
  const auto first = turn_at(1.0, rule.output(bottom, nullptr, 1, 1.0));
  EXPECT_EQ(first.y, rule.output(bottom, nullptr, 1, 3.0));
  EXPECT_LE(rule.input(bottom, &first, 1, first.y + 1e-15, 0.5), 2.0);
  EXPECT_GE(rule.input(bottom, nullptr, 1, first.y + 1e-15, 0.5), 3.0);
  const auto top = turn_at(4.0, rule.output(bottom, nullptr, 1, 4.0));
  const auto last = turn_at(3.0, rule.output(top, nullptr, -1, 3.0));
  EXPECT_EQ(last.y, rule.output(top, nullptr, -1, 1.0));
  EXPECT_GE(rule.input(top, &last, -1, last.y - 1e-15, 3.5), 3.0);
  EXPECT_LE(rule.input(top, nullptr, -1, last.y - 1e-15, 3.5), 1.0);
}

TEST(KrasnoselskiiPokrovskii, TheInverseStopsAtTheTurnWhereNothingMovesBeyondIt) {
  Parameters values;
  values.set("u_min", 0.0).set("u_max", 4.0).set("offset", 0.0).set("a1", 1.0).set("a2", 0.0);
  values.set("interpolation", "bilinear");
  for (const char* weights : {"mu", "w"})
    values.set(weights, {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0});
  expect_no_way_past_the_turn<KpEverett>(KrasnoselskiiPokrovskii::from(values).table);
  expect_no_way_past_the_turn<BilinearEverett>(Preisach::from(values).table);
}

TEST(KrasnoselskiiPokrovskii, RateFunctionIsEquation3) {
  const auto classic = make_operator(kp_model(20, 6));
  const auto rated = make_operator(kp_model(20, 6, 0.96, 2.5e-4));
  classic->reset(0.0);
  rated->reset(0.0);
  double u = 0.0;
  for (const double next : {10.0, 60.0, 110.0, 70.0, 20.0}) {
    const double slope = (next - u) / 1e-2;
    u = next;
    const double y = classic->step(next, 1e-2) - 0.1;
    EXPECT_NEAR(rated->step(next, 1e-2) - 0.1, y * 0.96 * std::exp(-2.5e-4 * slope), 1e-12);
  }
  EXPECT_FALSE(rated->rate_independent());
  const Model model = kp_model(20, 6, 0.96, 1e-6);
  const auto forward = make_operator(model);
  const auto inverse = make_inverse(model);
  forward->reset(inverse->reset(0.2));
  for (int i = 0; i < 200; ++i) {
    const double wanted = 0.3 + 0.1 * std::sin(0.1 * i);
    ASSERT_NEAR(forward->step(inverse->step(wanted, 1e-3), 1e-3), wanted, 5e-3) << i;  // second order in a2
  }
}

TEST(KrasnoselskiiPokrovskii, ConvexSolveBeatsSwarmAndBothPredict) {
  const auto op = make_operator(kp_model(8, 3));
  std::vector<double> u = testing::modulated_triangle(3000, 0.0, 120.0, 60), y;
  for (std::size_t i = 0; i < u.size(); ++i) y.push_back(i == 0 ? op->reset(u[0]) : op->step(u[i], 1e-3));
  const TimeRecord record = testing::record(u, y);
  IdentifyOptions options;
  options.size = 8;
  const Identified convex =
      model_type_registry().get("krasnoselskii_pokrovskii").identify({&record, 1}, options);
  options.method = "paper";
  options.effort = 0.5;
  const Identified swarm =
      model_type_registry().get("krasnoselskii_pokrovskii").identify({&record, 1}, options);
  EXPECT_LT(testing::errors_of(convex, {&record, 1}).rms_percent, 0.01);
  EXPECT_LT(testing::errors_of(swarm, {&record, 1}).rms_percent, 3.0);
  EXPECT_GT(testing::errors_of(swarm, {&record, 1}).rms, testing::errors_of(convex, {&record, 1}).rms);
  const Identified again =
      model_type_registry().get("krasnoselskii_pokrovskii").identify({&record, 1}, options);
  EXPECT_EQ(again.model.parameters.list("mu"), swarm.model.parameters.list("mu"));  // same seed, same numbers
}

TEST(KrasnoselskiiPokrovskii, RateParametersAreFoundFromTwoRates) {
  const auto op = make_operator(kp_model(20, 9, 0.96, 3e-6));
  std::vector<TimeRecord> records;
  for (const double step_s : {1e-2, 1e-4}) {
    std::vector<double> u = testing::modulated_triangle(2000, 0.0, 120.0, 100), y;
    for (std::size_t i = 0; i < u.size(); ++i) y.push_back(i == 0 ? op->reset(u[0]) : op->step(u[i], step_s));
    records.push_back(testing::record(u, y, step_s));
  }
  IdentifyOptions options;
  options.size = 20;
  const Identified found = model_type_registry().get("krasnoselskii_pokrovskii").identify(records, options);
  // The slow record's own a1 and tiny rate effect are absorbed by the densities.
  EXPECT_NEAR(found.model.parameters.number("a1"), 1.0, 0.01);
  EXPECT_NEAR(found.model.parameters.number("a2"), 3e-6, 5e-7);
  EXPECT_LT(testing::errors_of(found, records).rms_percent, 0.5);
  const auto at_bound = [](const Identified& one) {
    return std::any_of(one.notes.begin(), one.notes.end(),
                       [](const std::string& note) { return note.starts_with("a2 is at its bound"); });
  };
  EXPECT_FALSE(at_bound(found));
  // Loops that narrow with speed: what eq. 3 cannot follow is said.
  std::swap(records[0].y, records[1].y);
  EXPECT_TRUE(at_bound(model_type_registry().get("krasnoselskii_pokrovskii").identify(records, options)));
}

}  // namespace
}  // namespace bodesmith::hysteresis
