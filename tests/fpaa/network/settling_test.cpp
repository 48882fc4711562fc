#include "fpaa/network/settling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fpaa/cams/filter_stage.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kBandwidthHz = 2e6, kGain = 1e4, kClockHz = 4e5;

/// exp(-pi beta GBW/fc), 1/(beta A).
void expect_left(const StageSwitches& stage, double beta) {
  const Unsettled left =
      unsettled(stage, {schematic::OpAmpModel::one_pole(Hertz{kBandwidthHz}, kGain)}, Hertz{kClockHz});
  EXPECT_NEAR(left.moving, std::exp(-std::numbers::pi * beta * kBandwidthHz / kClockHz), 1e-15);
  EXPECT_NEAR(left.by_gain, 1.0 / (beta * kGain), 1e-15);
}

TEST(Settling, IsTheFeedbacksShareOfWhatHangsAtTheInput) {
  StageSwitches stage;
  stage.capacitors = {static_branch("Cin", 30.0, PlateNode::input()),
                      static_branch("Cout", 50.0, PlateNode::opamp())};
  expect_left(stage, 50.0 / 80.0);
  // Capacitors that come in phase 1 alone make that phase the slower one; as a second way back they make it the quicker one.
  stage.capacitors.push_back(switched_branch("C2", 20.0, PlateNode::input()));
  expect_left(stage, 50.0 / 100.0);
  stage.capacitors.back() = switched_branch("C2", 20.0, PlateNode::opamp());
  expect_left(stage, 50.0 / 80.0);
  // The worst of two op-amps: the second reads the first and has less of its own.
  stage.opamps.resize(2);
  stage.capacitors.push_back(static_branch("Cn", 70.0, PlateNode::opamp(1), 2));
  stage.capacitors.push_back(static_branch("Cf", 10.0, PlateNode::opamp(2), 2));
  expect_left(stage, 10.0 / 80.0);
}

TEST(Settling, SwitchesChargeTheLargestCapacitorThroughTwoOfThem) {
  StageSwitches stage;
  stage.capacitors = {switched_branch("C2", 20.0, PlateNode::input()),
                      static_branch("Cout", 50.0, PlateNode::opamp())};
  SlowParts parts;
  EXPECT_EQ(unsettled(stage, parts, Hertz{kClockHz}).moving, 0.0) << "they follow at once";
  parts.switch_s = 1e-9;
  EXPECT_NEAR(unsettled(stage, parts, Hertz{kClockHz}).moving, std::exp(-0.5 / (kClockHz * 2e-9 * 50.0)),
              1e-15);
  EXPECT_EQ(unsettled(stage, parts, Hertz{kClockHz}).by_gain, 0.0);
}

/// The capacitors that bring noise are those that change plates and end at the op-amp's inverting input.
TEST(FilterStage, SwitchedUnitsAreThoseOfItsSwitches) {
  for (const auto& [kind, c] : {std::pair{FilterStage::Kind::first, std::vector<double>{3, 40, 5, 60}},
                                {FilterStage::Kind::second_low, {3, 5, 7, 11, 13, 17, 120, 140}},
                                {FilterStage::Kind::second_high, {3, 5, 7, 11, 13, 17, 120, 140}}}) {
    const FilterStage stage{kind, c};
    const std::vector<std::string> names =
        kind == FilterStage::Kind::first
            ? std::vector<std::string>{"Cin", "aCin", "Cout", "aCout"}
            : std::vector<std::string>{"C1", "Cp", "Cpp", "C2", "C3", "C4", "CA", "CB"};
    for (int opamp = 1; opamp <= stage.opamps(); ++opamp) {
      double moved = 0.0;
      for (const StageCapacitor& one : stage.switches(names, false).capacitors) {
        const bool there = one.far.phase1 == PlateNode::virtual_ground(opamp) ||
                           one.far.phase2 == PlateNode::virtual_ground(opamp);
        if (there && !(one.near.is_static() && one.far.is_static())) moved += one.units;
      }
      EXPECT_EQ(stage.switched_units(opamp), moved) << static_cast<int>(kind) << ", op-amp " << opamp;
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
