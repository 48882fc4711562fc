// A stage's figures are those of its transfer function, and its switches make that transfer function, charge by charge.
#include "fpaa/cams/filter_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace bodesmith::fpaa {
namespace {

using enum FilterStage::Kind;

/// Of one numerator, in volts an input, at f/fc.
double size_at(const FilterStage& stage, double turns) {
  return std::abs(stage.transfer().response({2.0 * std::numbers::pi * turns}, {1.0}));
}

TEST(FilterStage, ItsFiguresAreThoseOfItsTransfer) {
  for (const FilterStage::Kind kind : {second_low, second_high}) {
    for (const double c4 : {12.0, 60.0}) {
      FilterStage stage{kind, {20, 0, 0, 15, 17, c4, 150, 160}};
      const double f0 = stage.corner({1.0}).value;
      EXPECT_NEAR(size_at(stage, 0.0), stage.gain(), 1e-9);
      // What resonates: |H(f0)| = Q |H(0)|.
      EXPECT_NEAR(size_at(stage, f0) / size_at(stage, 0.0), stage.quality(), 1e-9 * stage.quality());
      stage.c[FilterStage::kC1] = 0.0;
      stage.c[FilterStage::kCp] = 20.0;
      EXPECT_NEAR(size_at(stage, f0), stage.gain(), 1e-9);
      EXPECT_LT(size_at(stage, 1.2 * f0), stage.gain());
      EXPECT_LT(size_at(stage, 0.8 * f0), stage.gain());
    }
  }
  const FilterStage high{second_high, {0, 0, 30, 2, 2, 3, 250, 240}};
  EXPECT_NEAR(size_at(high, 0.45), high.gain(), 0.02 * high.gain());
  // One op-amp: -(Cin + aCin D)/(Cout + aCout D), its pole where 2 tan(pi f0/fc) = 2 Cout/(Cout + 2 aCout).
  const FilterStage pole_zero{first, {10, 70, 5, 100}};
  EXPECT_NEAR(size_at(pole_zero, 0.0), 2.0, 1e-12);
  EXPECT_NEAR(pole_zero.gain(), 2.0, 1e-12);
  EXPECT_NEAR(size_at(pole_zero, 0.5), 150.0 / 205.0, 1e-12);
  EXPECT_NEAR(pole_zero.corner({1.0}).value, std::atan(5.0 / 205.0) / std::numbers::pi, 1e-12);
  const FilterStage high_pass{first, {0, 70, 5, 100}};
  EXPECT_NEAR(size_at(high_pass, 0.5), high_pass.gain(), 1e-12);
  EXPECT_NEAR(size_at(high_pass, high_pass.corner({1.0}).value), high_pass.gain() / std::sqrt(2.0), 1e-9);
}

TEST(FilterStage, SaysWhatItTakes) {
  const FilterStage two_inputs{first, {3, 4, 0, 5, 6, 7}};
  EXPECT_EQ(two_inputs.inputs(), 2U);
  EXPECT_FALSE(two_inputs.is_vendors());
  EXPECT_EQ(two_inputs.capacitor_count(), 5);
  EXPECT_EQ(two_inputs.resources().capacitors, 5);
  EXPECT_EQ(two_inputs.switched_units(1), 3.0 + 6.0);
  EXPECT_EQ((std::vector{two_inputs.input_of(0), two_inputs.input_of(1), two_inputs.input_of(2),
                         two_inputs.input_of(3), two_inputs.input_of(4), two_inputs.input_of(5)}),
            (std::vector{0, 0, 1, 1, -1, -1}));
  // The smaller one of an input; never a feedback.
  EXPECT_TRUE(two_inputs.may_be_left_out(0));
  EXPECT_FALSE(two_inputs.may_be_left_out(1));
  EXPECT_TRUE(two_inputs.may_be_left_out(2));
  EXPECT_FALSE(two_inputs.may_be_left_out(4));
  EXPECT_TRUE((FilterStage{first, {1, 2, 1, 2}}).is_stable());
  EXPECT_FALSE((FilterStage{first, {1, 2, 0, 2}}).is_stable());

  FilterStage low{second_low, {20, 0, 0, 15, 17, 12, 255, 256}};
  EXPECT_TRUE(low.is_vendors());
  EXPECT_EQ(low.capacitor_count(), 6);
  EXPECT_EQ(low.resources().capacitors, 7) << "CB takes a second bank, CA fills its one";
  EXPECT_EQ(low.largest_units(FilterStage::kCA), 510.0);
  EXPECT_EQ(low.largest_units(FilterStage::kCB), 510.0);
  EXPECT_EQ(low.largest_units(FilterStage::kC2), 255.0);
  EXPECT_EQ(low.switched_units(1), 35.0);
  EXPECT_EQ(low.switched_units(2), 17.0 + 12.0);
  low.c1_inverting = false;
  EXPECT_FALSE(low.is_vendors());
  FilterStage both{second_high, {20, 3, 0, 15, 17, 12, 255, 255}};
  EXPECT_FALSE(both.is_vendors()) << "two inputs at once";
  EXPECT_EQ(both.largest_units(FilterStage::kCA), 255.0)
      << "seven capacitors leave no room for a second bank";
  EXPECT_EQ(both.switched_units(2), 17.0) << "C4 and Cp are static";
  EXPECT_EQ(both.input_of(FilterStage::kCpp), 0);
  EXPECT_EQ(both.input_of(FilterStage::kC2), -1);
  EXPECT_TRUE(both.may_be_left_out(FilterStage::kCp));
  EXPECT_FALSE(both.may_be_left_out(FilterStage::kC1));
}

/// Outputs in phase 1 after a unit at `input` for one period from rest: charge is kept at every virtual ground.
std::vector<double> impulse_response(const StageSwitches& stage, int input, int count) {
  const std::size_t opamps = stage.opamps.size();
  std::vector<double> v(opamps, 0.0), near(stage.capacitors.size(), 0.0), out;
  for (int n = 0; n < count; ++n) {
    for (const bool first_phase : {true, false}) {
      const auto node = [&](const Plate& plate) { return first_phase ? plate.phase1 : plate.phase2; };
      // sum over what is at ground k of C (near now - near before) = 0, near now an input or an op-amp's output.
      double a[2][2] = {{0.0, 0.0}, {0.0, opamps < 2 ? 1.0 : 0.0}}, b[2] = {0.0, 0.0};
      const auto known = [&](const PlateNode& at) {
        return at.kind == PlateNode::Kind::input && at.number == input && n == 0 ? 1.0 : 0.0;
      };
      for (std::size_t k = 0; k < stage.capacitors.size(); ++k) {
        const StageCapacitor& c = stage.capacitors[k];
        if (node(c.far).kind != PlateNode::Kind::virtual_ground) continue;
        const auto row = static_cast<std::size_t>(node(c.far).number - 1);
        const PlateNode source = node(c.near);
        b[row] += c.units * (near[k] - known(source));
        if (source.kind == PlateNode::Kind::opamp) a[row][source.number - 1] += c.units;
      }
      const double determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
      v[0] = (b[0] * a[1][1] - a[0][1] * b[1]) / determinant;
      if (opamps > 1) v[1] = (a[0][0] * b[1] - b[0] * a[1][0]) / determinant;
      for (std::size_t k = 0; k < stage.capacitors.size(); ++k) {
        const PlateNode at = node(stage.capacitors[k].near);
        near[k] = at.kind == PlateNode::Kind::opamp ? v[static_cast<std::size_t>(at.number - 1)] : known(at);
      }
      if (first_phase) out.push_back(v[static_cast<std::size_t>(stage.output - 1)]);
    }
  }
  return out;
}

std::vector<double> impulse_response(const ZTransfer& transfer, std::size_t input, int count) {
  std::vector<double> out;
  const std::vector<double>&up = transfer.numerators[input - 1], &down = transfer.denominator;
  for (std::size_t n = 0; n < static_cast<std::size_t>(count); ++n) {
    double sum = n < up.size() ? up[n] : 0.0;
    for (std::size_t k = 1; k < down.size() && k <= n; ++k) sum -= down[k] * out[n - k];
    out.push_back(sum / down[0]);
  }
  return out;
}

TEST(FilterStage, ItsSwitchesMakeItsTransfer) {
  const std::vector<std::string> names = {"C1", "Cp", "Cpp", "C2", "C3", "C4", "CA", "CB"};
  std::vector<FilterStage> stages = {
      {first, {10, 70, 5, 100}}, {first, {10, 0, 5, 100}}, {first, {3, 4, 7, 5, 6, 90}}};
  for (const FilterStage::Kind kind : {second_low, second_high}) {
    for (const std::size_t input : {0U, 1U, 2U}) {
      FilterStage stage{kind, {0, 0, 0, 15, 17, 12, 300, 260}};
      stage.c[input] = 20;
      stages.push_back(stage);
      stage.c1_inverting = false;
      if (input == 0) stages.push_back(stage);
    }
    stages.push_back({kind, {20, 7, 9, 15, 17, 12, 150, 160}});
  }
  for (const FilterStage& stage : stages) {
    std::vector<std::string> own(stage.c.size());
    for (std::size_t i = 0; i < own.size(); ++i)
      own[i] = stage.c[i] > 0.0 ? (stage.is_first() ? "C" + std::to_string(i) : names[i]) : "";
    for (const bool banks : {false, true}) {
      const StageSwitches switches = stage.switches(own, banks);
      double units = 0.0;
      for (const StageCapacitor& c : switches.capacitors) {
        units += c.units;
        EXPECT_LE(c.units, banks ? 255.0 : 510.0) << c.name;
      }
      double wanted = 0.0;
      for (const double c : stage.c) wanted += c;
      EXPECT_DOUBLE_EQ(units, wanted);
      for (std::size_t input = 1; input <= stage.inputs(); ++input) {
        const auto made = impulse_response(switches, static_cast<int>(input), 12);
        const auto closed = impulse_response(stage.transfer(), input, 12);
        for (std::size_t n = 0; n < made.size(); ++n)
          EXPECT_NEAR(made[n], closed[n], 1e-9)
              << static_cast<int>(stage.kind) << " " << n << " " << own[0] << own[1];
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
