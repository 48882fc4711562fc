#include "fpaa/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "fpaa/cams/hold.hpp"
#include "fpaa/polynomial_error.hpp"
#include "seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

using ::testing::HasSubstr;

/// First seed: full-stroke polynomials of both branches.
Disturbance seed_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  return d;
}

void expect_legal(const ControllerVariant& v) {
  const Board& board = an231k04_quad4();
  std::map<std::pair<int, int>, Resources> cabs;
  std::map<int, int> tables;
  std::map<std::string, const ControllerCam*> by_name;
  for (const ControllerCam& cam : v.cams) {
    EXPECT_TRUE(by_name.emplace(cam.name, &cam).second) << cam.name << " twice";
    Resources in_cab = cam.resources;
    tables[cam.chip] += in_cab.lookup_tables;
    in_cab.lookup_tables = 0;
    cabs[{cam.chip, cam.cab}] += in_cab;
    EXPECT_GE(cam.chip, 1);
    EXPECT_LE(cam.chip, board.chips);
  }
  for (const auto& [place, used] : cabs)
    EXPECT_TRUE(used.fits_in(board.per_cab)) << place.first << "." << place.second;
  for (const auto& [chip, count] : tables) EXPECT_LE(count, 1) << "chip " << chip;
  for (const int cells : v.io_cells) EXPECT_LE(cells, board.io_cells_per_chip);
  // A half-cycle output goes nowhere but to CAMs of its own clock on its own chip, or to a Hold.
  for (const ControllerCam& cam : v.cams) {
    for (const std::string& input : cam.inputs) {
      const auto source = by_name.find(input);
      if (source == by_name.end() || !source->second->half_cycle || cam.cam == &hold_cam()) continue;
      EXPECT_EQ(source->second->chip, cam.chip) << input << " to " << cam.name;
      EXPECT_EQ(source->second->clock_a.value, cam.clock_a.value) << input << " to " << cam.name;
    }
    // Two Holds in series sample in opposite phases.
    if (cam.cam == &hold_cam()) {
      const auto source = by_name.find(cam.inputs[0]);
      if (source != by_name.end() && source->second->cam == &hold_cam()) {
        EXPECT_NE(source->second->phase, cam.phase);
      }
    }
  }
}

TEST(Controller, SeedsWholeControllerFitsTheFourChips) {
  const Controller controller =
      value_or_throw(make_controller(seed_disturbance(), nullptr, &seed_plan(), {}));
  ASSERT_EQ(controller.variants.size(), 3u);
  for (const ControllerVariant& v : controller.variants) {
    EXPECT_TRUE(v.fits()) << to_string(v.by) << ": " << (v.fits() ? "" : v.refusal->reason);
    expect_legal(v);
    // Half a period of the compensator's 2 kHz clock is the most of the delay.
    EXPECT_GT(v.delay_s, 250e-6);
    EXPECT_LT(v.delay_s, 400e-6);
    EXPECT_GE(controller.best().max_error_percent, 0.0);
    EXPECT_LE(controller.best().max_error_percent, v.max_error_percent);
  }
  EXPECT_THAT(controller.why, HasSubstr("least worst error"));
  EXPECT_THAT(controller_sheet(controller), HasSubstr("DescendingSection1a"));
}

TEST(Controller, PolynomialErrorsAreThoseOfTheConverters) {
  const Disturbance d = seed_disturbance();
  // Look-up: half an input step times the steepest slope (0.3546), plus half an output step.
  const PolynomialError lookup = polynomial_error(d, PolynomialBy::lookup, 0.1);
  EXPECT_LT(lookup.max_percent, 100.0 * (0.6 / 512.0 + 0.09 / 254.0 * 1.1));
  EXPECT_GT(lookup.max_percent, 100.0 * 0.3 / 512.0);
  // Multipliers: Y is off by up to 3/256 V of 3 V, x^2 by as much of x.
  const PolynomialError multipliers = polynomial_error(d, PolynomialBy::multipliers, 0.1);
  EXPECT_GT(multipliers.max_percent, lookup.max_percent);
  EXPECT_LT(multipliers.max_percent, 100.0 * (0.6433 + 2 * 0.2887) * 1.5 / 256.0 * 1.5);
  EXPECT_LT(lookup.rms_percent, lookup.max_percent);
}

TEST(Controller, TwoCompensatorsStillFitAndTooManyAreRefused) {
  const Controller two = value_or_throw(make_controller(seed_disturbance(), &seed_plan(), &seed_plan(), {}));
  expect_legal(two.best());
  Sections many;
  for (int i = 0; i < 28; ++i)
    many.sections.push_back(Section::pole_zero(1.0, {50.0 + 10.0 * i}, {55.0 + 10.0 * i}));
  PlanOptions options;
  options.clock = Hertz{2000.0};
  const Plan big = plan_of(many, options);
  const Outcome<Controller> outcome = make_controller(seed_disturbance(), nullptr, &big, {});
  const Refusal* refusal = refusal_of(outcome);
  ASSERT_NE(refusal, nullptr) << "28 sections and the rest of the controller cannot fit";
  EXPECT_THAT(refusal->reason, HasSubstr("fit"));
  EXPECT_THAT(refusal->reason, HasSubstr("expected"));
}

TEST(Controller, AskedForWayIsTaken) {
  ControllerOptions options;
  options.polynomial = PolynomialBy::lookup;
  const Controller controller =
      value_or_throw(make_controller(seed_disturbance(), nullptr, &seed_plan(), options));
  EXPECT_EQ(controller.best().by, PolynomialBy::lookup);
  options.fast_clock = {3.0};
  EXPECT_NE(refusal_of(make_controller(seed_disturbance(), nullptr, nullptr, options)), nullptr);
}

}  // namespace
}  // namespace bodesmith::fpaa
