#include "measured/suspects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "chain/registry.hpp"
#include "simulate/record/record_simulator.hpp"

namespace bodesmith::measured {
namespace {

using chain::Block;
using chain::Chain;
using chain::PartChange;

constexpr std::size_t kPeriod = 400;

std::vector<double> shown(const Chain& chain, const TimeRecord& record) {
  return simulate::RecordSimulator(chain, record.step_s).run_once(record.u);
}

/// One period of a triangle from 0 to 1 and back.
TimeRecord triangle() {
  TimeRecord out;
  out.step_s = 1.0 / (100.0 * kPeriod);  // 100 Hz
  for (std::size_t i = 0; i <= kPeriod; ++i)
    out.u.push_back(1.0 - std::abs(1.0 - 2.0 * static_cast<double>(i) / kPeriod));
  return out;
}

/// x + x²/5, whose gain R1 and R2 set together and whose square R3; behind it a stage of gain 2.
Chain two_curves() {
  Block first = chain::make_block("polynomial");
  first.set("coefficients", std::vector<double>{0.0, 1.0, 0.2});
  const auto scaled_by = [](std::string part, double slope, double bend, double tolerance) {
    return PartChange{std::move(part),
                      "percent",
                      tolerance,
                      {{"coefficients[1]", slope, bend}, {"coefficients[2]", 0.2 * slope, bend}}};
  };
  first.parts = std::make_shared<const std::vector<PartChange>>(
      std::vector<PartChange>{scaled_by("R1", 0.01, 0.0, 1.0),
                              scaled_by("R2", -0.02, 0.01, 0.1),
                              {"R3", "percent", 1.0, {{"coefficients[2]", 0.01, 0.0}}},
                              {"M1, offset", "v", 0.01, {{"coefficients[0]", 1.0, 0.0}}},
                              scaled_by("R4", 0.001, 0.0, 1.0),
                              {.part = "U1", .noise_gain = {1.0, 2.0, 0.0}}});
  Block stage = chain::make_block("polynomial");
  stage.part = "stage";
  stage.set("coefficients", std::vector<double>{0.0, 2.0});
  Chain out;
  out.blocks = {first, stage};
  return out;
}

Chain with_part(Chain chain, std::size_t part, double departure) {
  const Block good = chain.blocks[0];
  chain.blocks[0] = good.with((*good.parts)[part], departure);
  return chain;
}

TEST(MeasuredSuspects, AreThePartsThatDoTheSameLeastDepartureOfItsToleranceFirst) {
  const Chain base = two_curves();
  const Chain found = with_part(base, 0, 8.0);
  TimeRecord record = triangle();
  record.y = shown(found, record);
  for (std::size_t i = 0; i < record.size(); ++i) record.y[i] += i % 2 == 0 ? 1e-4 : -1e-4;  // noise
  const auto all = suspects_of(found, base, "R1", 8.0, record);
  ASSERT_EQ(all.size(), 3u);  // R4 would have to be off by 80 %: that is no departure, it is another part
  EXPECT_EQ(all[0].part, "R1");
  EXPECT_EQ(all[0].departure, 8.0);
  EXPECT_EQ(all[0].words(), "R1 is 8 % above its value");
  EXPECT_FALSE(all[0].within_tolerance());
  // A stage's gain is right to 1 %.
  EXPECT_EQ(all[1].part, "stage: gain of its coefficients curve");
  EXPECT_NEAR(all[1].departure, 8.0, 0.01);
  EXPECT_EQ(all[1].tolerance, 1.0);
  // .08 = -.02 t/(1 + .01 t)
  EXPECT_EQ(all[2].part, "R2");
  EXPECT_NEAR(all[2].departure, -0.08 / 0.0208, 0.01);
  EXPECT_EQ(all[2].words(), "R2 is 3.8 % below its value");
}

TEST(MeasuredSuspects, AnOffsetIsToldInMillivolts) {
  const Chain base = two_curves();
  const Chain found = with_part(base, 3, -0.012);
  TimeRecord record = triangle();
  record.y = shown(found, record);
  for (std::size_t i = 0; i < record.size(); ++i) record.y[i] += i % 2 == 0 ? 1e-4 : -1e-4;
  const auto all = suspects_of(found, base, "M1, offset", -0.012, record);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].words(), "M1, offset is -12 mV");
  EXPECT_FALSE(all[0].within_tolerance());
  // It explains what another is accused of as well.
  const auto others = suspects_of(found, base, "R3", 5.0, record);
  ASSERT_EQ(others.size(), 2u);
  EXPECT_NEAR(others[0].departure, -0.012, 1e-5);
}

TEST(MeasuredSuspects, WithinItsToleranceIsUpToIt) {
  EXPECT_TRUE((Suspect{"R1", "percent", -1.0, 1.0}.within_tolerance()));
  EXPECT_FALSE((Suspect{"R1", "percent", -1.01, 1.0}.within_tolerance()));
}

/// A generator whose falling branch is .1 x, times a rate gain of 1, .8, .5 at 10, 100 and 1000 Hz.
Chain rated() {
  Block block = chain::make_block("polynomial_hysteresis");
  block.set("descending", std::vector<double>{0.1, 0.0, 0.0})
      .set("ascending", std::vector<double>{0.0, 0.0, 0.0})
      .set("rate_frequency_hz", std::vector<double>{10.0, 100.0, 1000.0})
      .set("rate_ascending", std::vector<double>{1.0, 1.0, 1.0})
      .set("rate_descending", std::vector<double>{1.0, 0.8, 0.5})
      .set("operating_hz", 100.0);
  block.parts = std::make_shared<const std::vector<PartChange>>(
      std::vector<PartChange>{{"Rcurve", "percent", 1.0, {{"descending[0]", 0.001, 0.0}}},
                              {"Rrate", "percent", 1.0, {{"rate_descending[1]", 0.008, 0.0}}}});
  Chain out;
  out.blocks = {block};
  return out;
}

TEST(SeparatingRecord, IsAtTheFrequencyWhereTheyDifferMost) {
  const Chain base = rated();
  const TimeRecord record = triangle();
  const std::vector<Suspect> both = {{"Rcurve", "percent", 8.0, 1.0}, {"Rrate", "percent", 8.0, 1.0}};
  // At 100 Hz they do the same; at 10 Hz, where the gain is 1, only the curve's part shows: .008 x as it falls.
  const auto other = separating_record(base, both, record, 100.0);
  ASSERT_TRUE(other.has_value());
  EXPECT_NEAR(other->frequency_hz, 10.0, 1e-9);
  EXPECT_NEAR(other->rms, 0.008 * std::sqrt(1.0 / 6.0), 0.008 * 0.005);
  // A stage's gain has no part in the table, and one alone needs no record.
  EXPECT_FALSE(separating_record(base, {both[0], {"stage: gain", "percent", 8.0, 1.0}}, record, 100.0));
  EXPECT_FALSE(separating_record(two_curves(), both, record, 100.0));
}

/// Where good parts stop to explain: of tolerances uniform between their limits (three to an offset's), up to a sum of squares of
/// 30 standard deviations.
TEST(GoodParts, ExplainUpToThirtySquares) {
  const Chain base = two_curves();
  const double noise = 1e-5;
  TimeRecord record = triangle();
  const auto further = [](const std::optional<GoodParts>& of) {
    return of ? std::optional(of->further) : std::nullopt;
  };
  const auto explained = [&](std::size_t part, double departure, const std::string& wrong = {}) {
    record.y = shown(with_part(base, part, departure), record);
    for (std::size_t i = 0; i < record.size(); ++i) record.y[i] += i % 2 == 0 ? noise : -noise;
    return further(good_parts_explain(base, record, noise, wrong));
  };
  const double deviations = std::sqrt(30.0);
  EXPECT_EQ(explained(0, 0.0), 0.0);
  EXPECT_EQ(explained(2, 0.99 * deviations / std::sqrt(3.0)), 0.0);
  EXPECT_FALSE(explained(2, 1.01 * deviations / std::sqrt(3.0)).has_value());
  EXPECT_EQ(explained(3, -0.99 * deviations * 0.01 / 3.0), 0.0);
  EXPECT_FALSE(explained(3, -1.01 * deviations * 0.01 / 3.0).has_value());
  // A part that is wrong may be off by more, and by how much is said.
  EXPECT_NEAR(explained(2, 20.0, "R3").value_or(0.0), 20.0, 0.01);
  // Nothing that the parts do makes a cubic.
  const auto left = [&](double cubic) {
    record.y = shown(base, record);
    for (std::size_t i = 0; i < record.size(); ++i) record.y[i] += cubic * std::pow(record.u[i], 3);
    return further(good_parts_explain(base, record, noise));
  };
  EXPECT_FALSE(left(0.01).has_value());
  EXPECT_EQ(left(1e-6), 0.0);
  Chain bare = base;
  bare.blocks[0].parts.reset();
  record.y = shown(with_part(base, 0, 1.0), record);
  EXPECT_FALSE(good_parts_explain(bare, record, noise).has_value());
}

/// The amplifier's lag on a triangle is a constant of either direction but for some samples at its turns; good parts that make the constant
/// are no match for a corner that makes both. Squares are additive: N of noise, one for each deviation.
TEST(GoodParts, ThatLeaveTheTurnsAreNoMatchForALag) {
  Block controller = chain::make_block("polynomial_hysteresis");
  controller.set("ascending", std::vector<double>(3)).set("descending", std::vector<double>(3));
  controller.parts = std::make_shared<const std::vector<PartChange>>(std::vector<PartChange>{
      {"M1, offset", "v", 0.015, {{"constant_ascending", 1.0, 0.0}, {"constant_descending", -1.0, 0.0}}}});
  Block amplifier = chain::make_block("lowpass");
  Chain fast, slow;
  fast.blocks = {controller, amplifier.set("corner_hz", 100e3)};
  slow.blocks = {controller, amplifier.set("corner_hz", 3e3)};
  constexpr double noise = 2.5e-3;
  TimeRecord record = triangle();
  const auto measure = [&](const Chain& truth) {
    record.y = shown(truth, record);
    for (std::size_t i = 0; i < record.size(); ++i) record.y[i] += i % 2 == 0 ? noise : -noise;
  };
  const double samples = static_cast<double>(record.size());
  measure(slow);
  const auto parts = good_parts_explain(fast, record, noise), lag = good_parts_explain(slow, record, noise);
  ASSERT_TRUE(parts.has_value());
  ASSERT_TRUE(lag.has_value());
  EXPECT_NEAR(lag->squares, samples, 1.0);
  // 2 c of a step decay with the lag at each turn: 4 c^2 q^2/(1 - q^2) of squares, c = 200 tau, q = exp(-step/tau).
  const double tau = 1.0 / (2.0 * std::numbers::pi * 3e3), q = std::exp(-record.step_s / tau);
  EXPECT_GT(parts->squares, samples + std::pow(400.0 * tau * q / noise, 2) / (1.0 - q * q));
  EXPECT_FALSE(good_parts_do_as_much(fast, slow, record, noise));
  EXPECT_TRUE(good_parts_do_as_much(slow, fast, record, noise));
  // Of a part's making it is the parts'.
  measure(with_part(fast, 0, 0.01));
  EXPECT_TRUE(good_parts_do_as_much(fast, slow, record, noise));
}

/// What a part does is bent: where its direction alone leaves eight times the noise, its departure leaves none.
TEST(GoodParts, AreMetAsTheyAreBent) {
  const Chain base = two_curves();
  TimeRecord record = triangle();
  constexpr double noise = 1e-4;
  record.y = shown(with_part(base, 1, 4.0), record);
  const auto met = good_parts_explain(base, record, noise, "R2");
  ASSERT_TRUE(met.has_value());
  EXPECT_NEAR(met->squares, std::pow(4.0 / (30.0 * 0.1), 2), 0.2);
}

}  // namespace
}  // namespace bodesmith::measured
