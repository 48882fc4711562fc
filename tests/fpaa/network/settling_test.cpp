#include "fpaa/network/settling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fpaa/cams/filter_stage.hpp"

namespace bodesmith::fpaa {
namespace {

/// exp(-pi beta GBW/fc) + 1/(beta A).
double left_over(double beta, const schematic::OpAmpModel& opamp, double clock) {
  return std::exp(-std::numbers::pi * beta * opamp.gain_bandwidth.value / clock) +
         1.0 / (beta * opamp.dc_gain);
}

TEST(Settling, IsTheFeedbacksShareOfWhatHangsAtTheInput) {
  const auto opamp = schematic::OpAmpModel::one_pole(Hertz{2e6}, 1e4);
  StageSwitches stage;
  stage.capacitors = {static_branch("Cin", 30.0, PlateNode::input()),
                      static_branch("Cout", 50.0, PlateNode::opamp())};
  EXPECT_NEAR(unsettled_share(stage, opamp, Hertz{4e5}), left_over(50.0 / 80.0, opamp, 4e5), 1e-15);
  // Capacitors that come in phase 1 alone make that phase the slower one; as a second way back they make it the quicker one.
  stage.capacitors.push_back(switched_branch("C2", 20.0, PlateNode::input()));
  EXPECT_NEAR(unsettled_share(stage, opamp, Hertz{4e5}), left_over(50.0 / 100.0, opamp, 4e5), 1e-15);
  stage.capacitors.back() = switched_branch("C2", 20.0, PlateNode::opamp());
  EXPECT_NEAR(unsettled_share(stage, opamp, Hertz{4e5}), left_over(50.0 / 80.0, opamp, 4e5), 1e-15);
  // The worst of two op-amps: the second reads the first and has less of its own.
  stage.opamps.resize(2);
  stage.capacitors.push_back(static_branch("Cn", 70.0, PlateNode::opamp(1), 2));
  stage.capacitors.push_back(static_branch("Cf", 10.0, PlateNode::opamp(2), 2));
  EXPECT_NEAR(unsettled_share(stage, opamp, Hertz{4e5}), left_over(10.0 / 80.0, opamp, 4e5), 1e-15);
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
