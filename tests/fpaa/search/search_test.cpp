// What the search designs: figures by the switched-network solver, which shares no code with the search.
#include "fpaa/search/search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/error_reference.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

using Root = std::complex<double>;

/// Largest |got - wanted| against error_reference(), in percent, at points that the search has not seen.
double solved_percent(const Plan& plan, const Sections& sections, Band band) {
  const SwitchedBoard board(plan);
  double worst = 0.0;
  for (const Hertz f : log_grid(band, 157)) {
    const RadPerSecond w = f.rad_s();
    worst = std::max(worst,
                     100.0 * std::abs(board.gain(w) - sections.response(w)) / error_reference(sections, w));
  }
  return worst;
}

/// From the fastest clock to the slowest, each a whole even number of the one before, and one system divisor a chip.
void expect_nested(const Plan& plan) {
  for (const ChipPlan& chip : plan.chips) EXPECT_EQ(chip.clocks.sys1_divisor, chip.clocks.sys2_divisor);
  double before = 1e12;
  for (const PlacedCam* cam : plan.cams()) {
    const double ratio = before / cam->clock_a.value;
    EXPECT_GE(ratio, 1.0 - 1e-9) << cam->name;
    const bool slower = before < 1e12 && ratio > 1.0 + 1e-9;
    EXPECT_NEAR(slower ? std::remainder(ratio, 2.0) : 0.0, 0.0, 1e-6) << cam->name;
    before = cam->clock_a.value;
  }
}

Section pair_section(double gain, double zero_hz, double zero_q, double pole_hz, double pole_q) {
  const auto pair = [](double hz, double q) -> std::vector<Root> {
    const double w = 2.0 * M_PI * hz;
    const double re = -w / (2.0 * q);
    const double im = std::sqrt(w * w - re * re);
    return {{re, im}, {re, -im}};
  };
  return {gain, pair(zero_hz, zero_q), pair(pole_hz, pole_q)};
}

Section low_pass_section(double hz, double q) {
  const double w = 2.0 * M_PI * hz;
  const double re = -w / (2.0 * q);
  const double im = std::sqrt(w * w - re * re);
  return {w * w, {}, {{re, im}, {re, -im}}};
}

PlanOptions within(double from, double to) {
  PlanOptions out;
  out.band = Band{{from}, {to}};
  return out;
}

struct Design4 {
  const char* name;
  Sections sections;
  Band band;
  double most_percent;
};

TEST(Search, PapersEightSections) {
  const PlanOptions options = within(1.0, 100.0);
  const Plan plan = plan_of(seed_sections(), options);
  expect_nested(plan);
  EXPECT_EQ(plan.chips.size(), 1u);
  EXPECT_LE(solved_percent(plan, seed_sections(), *options.band), 0.05);
  EXPECT_LE(plan.total->p95_percent, 0.5);
  EXPECT_GE(plan.max_input_v, 1.5);
}

TEST(Search, PapersConfigurationIsOneChipAtOneClock) {
  PlanOptions options = within(1.0, 100.0);
  options.topology = PlanOptions::Topology::bilinear;
  const Plan plan = plan_of(seed_sections(), options);
  EXPECT_EQ(plan.chips.size(), 1u);
  for (const PlacedCam* cam : plan.cams()) {
    EXPECT_EQ(cam->cam_name(), "FilterBilinear");
    EXPECT_EQ(cam->clock_a.value, plan.cams()[0]->clock_a.value);
  }
  EXPECT_LE(solved_percent(plan, seed_sections(), *options.band), 0.25);
  Sections complex;
  complex.sections = {low_pass_section(1000.0, 1.3)};
  EXPECT_NE(refusal_of(make_plan(complex, options)), nullptr);
}

/// The curve is of plans' figures, the one taken among them, and no design on it is beaten by another in all three.
TEST(Search, RanksByWhatPlansState) {
  Sections resonance;
  const double w = 2.0 * M_PI * 1000.0;
  resonance.sections = {{w / 20.0, {0.0}, {Root(-w / 40.0, w), Root(-w / 40.0, -w)}}};
  const Plan plan = plan_of(resonance, within(100.0, 10000.0));
  ASSERT_FALSE(plan.trade_off.empty());
  const auto chosen = std::find_if(plan.trade_off.begin(), plan.trade_off.end(),
                                   [](const TradeOff& at) { return at.chosen; });
  ASSERT_NE(chosen, plan.trade_off.end());
  EXPECT_EQ(chosen->p95_percent, plan.total->p95_percent);
  EXPECT_EQ(chosen->at_input_v, plan.total->at_input_v);
  for (std::size_t i = 0; i < plan.trade_off.size(); ++i) {
    const TradeOff& one = plan.trade_off[i];
    EXPECT_TRUE(i == 0 || plan.trade_off[i - 1].at_input_v <= one.at_input_v);
    for (const TradeOff& other : plan.trade_off)
      EXPECT_FALSE(other.at_input_v >= one.at_input_v && other.designed_percent <= one.designed_percent &&
                   other.p95_percent < one.p95_percent)
          << "the design of " << other.at_input_v << " V beats the one of " << one.at_input_v << " V";
  }
}

/// Four capacitors place the zero; at no clock do the largest leave less than 3.4 % of 95 % of boards.
TEST(Search, ANotchIsAsGoodAsItsCapacitorsCanBe) {
  Sections notch;
  const double w = 2.0 * M_PI * 50.0, re = -w / 4.0, im = w * std::sqrt(1.0 - 1.0 / 16.0);
  notch.sections = {{1.0, {Root(0.0, w), Root(0.0, -w)}, {Root(re, im), Root(re, -im)}}};
  const Plan plan = plan_of(notch, within(5.0, 500.0));
  const std::string said = " alone puts 95 % of boards ";
  const auto note = std::find_if(plan.notes.begin(), plan.notes.end(),
                                 [&](const std::string& one) { return one.find(said) != std::string::npos; });
  ASSERT_NE(note, plan.notes.end());
  const double least = std::stod(note->substr(note->find(said) + said.size()));
  EXPECT_GT(least, 3.38);
  EXPECT_GT(plan.total->mismatch_p95_percent, 0.9 * least);
  EXPECT_LT(plan.total->mismatch_p95_percent, 1.3 * least);
}

TEST(Search, WhatNoClockReachesIsRefusedAtOnce) {
  Sections far;
  far.sections = {{1.0, {{-1e150, 0.0}}, {{-100.0, 0.0}}}};
  const auto made = make_plan(far, {});
  ASSERT_NE(refusal_of(made), nullptr);
  EXPECT_THAT(refusal_of(made)->reason, testing::HasSubstr("below the board's clock"));
}

TEST(Search, LowPassesAreNoLongerBent) {
  // Butterworth 4 and Bessel 4 at 1 kHz, one low pass at 500 Hz: 19 % off by charges while they made up for holds.
  const double w = 2.0 * M_PI * 500.0;
  Sections one;
  one.sections = {{w, {}, {-w}}};
  Sections butterworth;
  butterworth.sections = {low_pass_section(1000.0, 0.5412), low_pass_section(1000.0, 1.3066)};
  Sections bessel;
  bessel.sections = {low_pass_section(1432.0, 0.5219), low_pass_section(1606.0, 0.8055)};
  const Design4 all[] = {{"one", one, {{50.0}, {3000.0}}, 0.6},
                         {"butterworth", butterworth, {{100.0}, {3000.0}}, 1.0},
                         {"bessel", bessel, {{286.0}, {5000.0}}, 1.0}};
  for (const Design4& d : all) {
    const Plan plan = plan_of(d.sections, within(d.band.from.value, d.band.to.value));
    expect_nested(plan);
    EXPECT_EQ(plan.topology, "chain") << d.name;
    EXPECT_LE(solved_percent(plan, d.sections, d.band), d.most_percent) << d.name;
    EXPECT_GE(plan.max_input_v, 1.0) << d.name;
  }
}

TEST(Search, ZerosInTheRightHalfPlaneAndComplexOnes) {
  Sections all_pass;
  all_pass.sections = {{-1.0, {2.0 * M_PI * 100.0}, {-2.0 * M_PI * 100.0}}};
  Sections complex;
  complex.sections = {pair_section(1.0, 500.0, 3.0, 700.0, 1.2), pair_section(0.8, 90.0, 0.8, 150.0, 2.0)};
  const Design4 cases[] = {{"all pass", all_pass, {{1.0}, {10000.0}}, 0.6},
                           {"complex", complex, {{90.0}, {700.0}}, 1.0}};
  for (const Design4& d : cases) {
    const Plan plan = plan_of(d.sections, within(d.band.from.value, d.band.to.value));
    expect_nested(plan);
    EXPECT_EQ(plan.topology, "cascade") << d.name;
    EXPECT_LE(solved_percent(plan, d.sections, d.band), d.most_percent) << d.name;
  }
}

TEST(Search, AWeightingOfExactPolesIsAChainOfTheVendorsCams) {
  const double pole[] = {20.598997, 20.598997, 107.65265, 737.86223, 12194.217, 12194.217};
  Sections sections;
  const double top = 2.0 * M_PI * pole[4];
  sections.sections = {{1.0, {0.0, 0.0}, {-2.0 * M_PI * pole[0], -2.0 * M_PI * pole[1]}},
                       {1.0, {0.0, 0.0}, {-2.0 * M_PI * pole[2], -2.0 * M_PI * pole[3]}},
                       {1.2589 * top * top, {}, {-top, -top}}};
  const Plan plan = plan_of(sections, within(20.0, 20000.0));
  expect_nested(plan);
  EXPECT_EQ(plan.topology, "chain");
  EXPECT_LE(solved_percent(plan, sections, {{20.0}, {20000.0}}), 1.0);
  EXPECT_GE(plan.max_input_v, 1.7);
}

TEST(Search, NoClockBelowTheLowest) {
  PlanOptions options = within(10.0, 4000.0);
  options.lowest_clock = Hertz{31400.0};
  Sections sections;
  sections.sections = {Section::pole_zero(1.0, {2.0 * M_PI * 150.0}, {2.0 * M_PI * 100.0}),
                       Section::pole_zero(1.0, {2.0 * M_PI * 4000.0}, {2.0 * M_PI * 3000.0})};
  const Plan plan = plan_of(sections, options);
  for (const PlacedCam* cam : plan.cams()) EXPECT_GE(cam->clock_a.value, 31400.0 * 0.99);
  EXPECT_LE(solved_percent(plan, sections, *options.band), 1.0);
}

TEST(Search, RefusalSaysWhatWasTried) {
  Sections sections;
  // A resonance of Q 3000 at 60 kHz: below what whole capacitors resolve.
  const double w = 2.0 * M_PI * 6e4;
  sections.sections.push_back({w / 3000.0, {0.0}, {{-w / 6000.0, w}, {-w / 6000.0, -w}}});
  const auto made = make_plan(sections, {});
  const Refusal* refusal = refusal_of(made);
  ASSERT_NE(refusal, nullptr);
  EXPECT_THAT(refusal->reason, ::testing::HasSubstr("tried"));
}

}  // namespace
}  // namespace bodesmith::fpaa
