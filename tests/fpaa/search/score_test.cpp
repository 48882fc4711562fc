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
  return score_of(design, table, BoardAssumptions(), 3.0, Spread::by_frequency).noise;
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

}  // namespace
}  // namespace bodesmith::fpaa
