// The noise of a design against kT/C by hand, and what comes of exchanging clocks and units.
#include "fpaa/search/score.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace bodesmith::fpaa {
namespace {

DesignTarget flat_target(double from_hz, double to_hz) {
  DesignTarget out;
  out.master_hz = 1e6;
  out.band = {{from_hz}, {to_hz}};
  for (int k = 0; k < 11; ++k) {
    out.grid.push_back(Hertz{from_hz + (to_hz - from_hz) * k / 10.0}.rad_s());
    out.wanted.emplace_back(-1.0);
    out.weight.push_back(1.0);
    out.reciprocal.push_back(1.0);
  }
  return out;
}

/// A low pass of gain 1 far above the band, and what it scores.
double noise_of(std::int64_t divisor, double units, double to_hz) {
  DesignStage stage;
  stage.kind = FilterStage::Kind::first;
  stage.divisor = divisor;
  stage.from = {DesignStage::kBoardInput};
  stage.c = {units, 0.0, units, 0.2 * units};
  Design design;
  design.stages = {stage};
  const DesignTarget target = flat_target(1.0, to_hz);
  const StageFactorTable table(target);
  return score_of(design, table, BoardAssumptions(), Spread::by_frequency).noise;
}

TEST(Score, NoiseInTheBandIsThatOfTheSwitchedCapacitors) {
  const NoiseModel model;
  // Cin and Cout bring 2 kT C a period; in the band 2/fc of the spectrum's double side; divided by Cout at rest.
  const double density = 2.0 * (40.0 + 40.0) * 2.0 / 1e5 / (40.0 * 40.0);
  const double rms = model.unit_noise_v() * std::sqrt(density * (101.0 - 1.0));
  const double share = model.weight * rms / (3.0 / std::sqrt(2.0));
  EXPECT_NEAR(noise_of(10, 40.0, 101.0), share, 0.01 * share);
  // Of half the clock, a quarter of the units, four times the band: root two, two and two as much.
  EXPECT_NEAR(noise_of(20, 40.0, 101.0) / noise_of(10, 40.0, 101.0), std::sqrt(2.0), 0.01);
  EXPECT_NEAR(noise_of(10, 10.0, 101.0) / noise_of(10, 40.0, 101.0), 2.0, 0.01);
  EXPECT_NEAR(noise_of(10, 40.0, 401.0) / noise_of(10, 40.0, 101.0), 2.0, 0.02);
}

// A charge into the first op-amp of a stage is held up at rest by C2 alone; into the second one it is taken away by the first.
TEST(Score, ChargesIntoASecondOrderStageEndWhereItsLoopTakesThem) {
  DesignTarget target = flat_target(1e-3, 2e-3);
  const StageFactorTable table(target);
  for (const FilterStage::Kind kind : {FilterStage::Kind::second_low, FilterStage::Kind::second_high}) {
    DesignStage stage;
    stage.kind = kind;
    stage.divisor = 10;
    stage.from = {DesignStage::kBoardInput};
    stage.c = {30, 0, 0, 40, 70, 60, 200, 180};
    const auto& clock = table.clock(10)[0];
    EXPECT_NEAR(std::abs(charge_response(stage, 1, clock).end1.at(0)), 1.0 / 40.0, 1e-6);
    EXPECT_LT(std::abs(charge_response(stage, 2, clock).end1.at(0)), 1e-6);
  }
}

// Near a multiple of its clock a slow stage sees a constant: its gain at rest counts, though the band has next to none of it.
TEST(Score, PeaksNearMultiplesOfASlowClockCount) {
  const auto low_pass = [](std::int64_t divisor, int from, std::vector<double> c) {
    DesignStage out;
    out.kind = FilterStage::Kind::first;
    out.divisor = divisor;
    out.from = {from};
    out.c = std::move(c);
    return out;
  };
  Design design;
  design.stages = {low_pass(10, DesignStage::kBoardInput, {50, 0, 50, 10}),
                   low_pass(1000, 0, {40, 0, 10, 159})};
  const DesignTarget target = flat_target(300.0, 400.0);
  const StageFactorTable table(target);
  const DesignResponse response(design, table);
  EXPECT_LT(std::abs(response.output(0)), 0.3);
  const std::vector<NodePeak> peaks = node_peaks(response);
  EXPECT_NEAR(peaks[0].output, 1.0, 0.05);
  EXPECT_NEAR(peaks[1].output, 4.0, 0.1);
}

TEST(Score, WhatDesignsAreComparedBy) {
  DesignScore score{
      .designed = 0.004, .p95 = 0.03, .noise = 0.01, .input = 0.5, .bound = 0.75, .image = 0.04};
  EXPECT_NEAR(score.total(), 0.05 + 0.01, 1e-15);  // two thirds of the bound are the input
  score.input = 0.25;
  EXPECT_NEAR(score.total(), 0.06 + 0.005, 1e-15);
  EXPECT_NEAR(score.wanted_input(), 1.0 / 3.0, 1e-15);  // 1 V
  score.bound = 0.3;
  EXPECT_NEAR(score.wanted_input(), 0.2, 1e-15);
  score = {.designed = 0.01, .p95 = 0.018, .noise = 0.024, .input = 0.25, .bound = 0.75, .image = 0.0};
  EXPECT_NEAR(score.missing(), 1.0 + 1.0 + 1.0 / 3.0, 1e-12);
  score = {.designed = 0.005, .p95 = 0.009, .noise = 0.012, .input = 1.0 / 3.0, .bound = 0.75, .image = 0.0};
  EXPECT_EQ(score.missing(), 0.0);
  score = {.designed = 0.01, .p95 = 0.03, .noise = 0.0, .input = 1.0, .bound = 1.0, .image = 0.0};
  EXPECT_NEAR(score.rank(8, true), 0.04 * 1.08, 1e-7);
  EXPECT_NEAR(score.rank(9, true), 0.04 * 1.19, 1e-7);  // another chip
  EXPECT_NEAR(score.rank(17, false), 0.04 * 1.37 + 1e-3, 1e-7);
  EXPECT_EQ(score.place(0.0, 8, true), std::pair(0, score.rank(8, true)));
  EXPECT_EQ(score.place(0.5, 8, true).first, 1);
  EXPECT_NEAR(score.place(0.5, 8, true).second, 1.5 * score.rank(8, true), 1e-6);
  // Of no use for its images: after one that takes a thirtieth of the input.
  DesignScore useless = score, low = score;
  useless.image = 0.26;
  low.image = 0.24;
  low.input /= 30.0;
  EXPECT_LT(low.place(low.missing(), 8, true), useless.place(0.0, 8, true));
}

TEST(Score, MismatchAddsBySquaresFrequencyByFrequency) {
  Design design;
  design.stages.resize(2);
  design.stages[0].c = {25.0, 100.0};
  design.stages[1].c = {4.0};
  const std::vector<Complex> a{{0.0, 3.0}, {1.0, 0.0}, 0.0}, b{{4.0, 0.0}, 0.0, 0.0},
      c{0.0, {0.0, -1.0}, 0.0};
  CapacitorEffects effects;
  effects.list = {{0, 0, a}, {0, 1, b}, {1, 0, c}};
  const std::vector<double> got =
      errors_of_95_percent({{0.3, 0.4}, 0.0, -0.2}, effects, design, MismatchModel{1.0, 0.0});
  ASSERT_EQ(got.size(), 3u);
  EXPECT_NEAR(got[0], 0.5 + 1.959964 * std::hypot(3.0 * 0.002, 4.0 * 0.001), 1e-8);
  EXPECT_NEAR(got[1], 1.959964 * std::hypot(0.002, 0.005), 1e-8);
  EXPECT_NEAR(got[2], 0.2, 1e-15);
}

}  // namespace
}  // namespace bodesmith::fpaa
