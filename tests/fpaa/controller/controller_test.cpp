#include "fpaa/controller/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "base/documents/json.hpp"
#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/controller/gains.hpp"
#include "fpaa/controller/io.hpp"
#include "fpaa/controller/netlist.hpp"
#include "fpaa/controller/run.hpp"
#include "fpaa/plan/plan_graph.hpp"
#include "fpaa/seed_sections.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "kept_text.hpp"
#include "texts.hpp"

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

/// With Table I's gains of the descending branch.
Disturbance seed_with_rates() {
  Disturbance d = seed_disturbance();
  d.rate.frequency = {{1}, {10}, {20}, {60}, {100}};
  d.rate.ascending = {1, 1, 1, 1, 1};
  d.rate.descending = {1, 1.06, 1.1, 1.04, 1.17};
  return d;
}

const ControllerVariant& variant_of(const Controller& controller, PolynomialBy by,
                                    ControllerStructure structure) {
  for (const ControllerVariant& v : controller.variants) {
    if (v.by == by && v.structure == structure) return v;
  }
  throw std::logic_error("no such variant");
}

void expect_legal_controller(const ControllerVariant& v) {
  SCOPED_TRACE(v.name());
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
    for (const Capacitor& c : cam.capacitors) EXPECT_LE(c.units, kMostUnits) << cam.name;
  }
  for (const auto& [place, used] : cabs)
    EXPECT_TRUE(used.fits_in(kPerCab)) << place.first << "." << place.second;
  for (const auto& [chip, count] : tables) EXPECT_LE(count, 1) << "chip " << chip;
  for (const int cells : v.io_cells) EXPECT_LE(cells, kIoCells);
  // A half-cycle output goes nowhere but to CAMs of its own clock on its own chip, or to a Hold.
  for (const ControllerCam& cam : v.cams) {
    for (const std::string& input : cam.inputs) {
      const auto source = by_name.find(input);
      if (source == by_name.end() || !source->second->cam->facts().half_cycle_output ||
          cam.cam == &hold_cam())
        continue;
      EXPECT_EQ(source->second->chip, cam.chip) << input << " to " << cam.name;
      EXPECT_EQ(source->second->clock_a.value, cam.clock_a.value) << input << " to " << cam.name;
    }
  }
  for (const OutsidePart& part : v.outside) {
    for (const std::string& input : part.inputs) {
      if (const ControllerCam* source = v.find(input)) {
        EXPECT_FALSE(source->cam->facts().half_cycle_output) << input;
      }
    }
  }
}

/// A full-stroke triangle.
ControllerReference triangle(double hertz) {
  const auto phase = [hertz](double t) { return t * hertz - std::floor(t * hertz); };
  return {[phase](double t) { return 1.0 - std::abs(1.0 - 2.0 * phase(t)); },
          [phase](double t) { return phase(t) < 0.5; }};
}

/// Largest |v + K d(v) - r| over a period, but for a hundredth of it behind each corner.
double worst_residue(const ControllerVariant& variant, const Disturbance& d, double hertz) {
  const ControllerReference reference = triangle(hertz);
  ControllerRun run(variant.at(d, {hertz}), reference);
  double out = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double theta = i / 4000.0;
    const double v = run.drive(theta / hertz);
    const auto branch = theta < 0.5 ? Disturbance::Branch::ascending : Disturbance::Branch::descending;
    const double y = v + d.rate_gain(branch, {hertz}) * d.value(branch, v);
    if (std::fmod(theta, 0.5) > 0.01) out = std::max(out, std::abs(y - reference.x(theta / hertz)));
  }
  EXPECT_THAT(run.clipped(), ::testing::IsEmpty());
  return out;
}

// Samples far apart are those of a run that leaves no clock out.
TEST(Controller, SlowReferencesArePassedOverWhereTheLoopHasSettled) {
  const auto expect_same = [](const ControllerVariant& variant, double apart_s) {
    const double hertz = 0.05 / apart_s;
    const ControllerVariant at = variant.at(seed_disturbance(), {hertz});
    ControllerRun passing(at, triangle(hertz)), whole(at, triangle(hertz));
    for (int i = 1; i < 4; ++i) {
      for (int k = 1; k < 10; ++k) whole.drive((i - 1 + 0.1 * k) * apart_s);
      EXPECT_NEAR(passing.drive(i * apart_s), whole.drive(i * apart_s), 1e-9) << variant.name() << " " << i;
    }
  };
  for (const ControllerVariant& variant :
       value_or_throw(make_controller(seed_disturbance(), {}, {})).variants) {
    if (variant.fits()) expect_same(variant, 0.0051234567);
  }
  // Compensators of a slow clock of their own.
  expect_same(value_or_throw(make_controller(seed_disturbance(), {nullptr, &seed_plan()}, {})).best(),
              0.51234567);
}

TEST(Controller, SeedsWholeControllerFitsTheFourChips) {
  const Controller controller =
      value_or_throw(make_controller(seed_disturbance(), {nullptr, &seed_plan()}, {}));
  ASSERT_EQ(controller.variants.size(), 12u);
  for (const ControllerVariant& v : controller.variants) {
    if (v.structure == ControllerStructure::two_pass) continue;
    EXPECT_TRUE(v.fits()) << v.name() << ": " << (v.fits() ? "" : v.refusal->reason);
    expect_legal_controller(v);
    // Cycles of the fast clock: the compensator's stages follow their input, its 2 kHz clock holds nothing back.
    EXPECT_GT(v.delay_s, 4e-6);
    EXPECT_LT(v.delay_s, 50e-6);
  }
  EXPECT_THAT(controller.why, HasSubstr("least worst error"));
  EXPECT_EQ(controller.best().structure, ControllerStructure::loop);
  EXPECT_THAT(controller_sheet(controller), HasSubstr("DescendingSection1a"));
}

TEST(Controller, PolynomialErrorsAreThoseOfTheConverters) {
  const Controller controller = value_or_throw(make_controller(seed_disturbance(), {}, {}));
  const auto error = [&](PolynomialBy by) {
    return variant_of(controller, by, ControllerStructure::open).max_error_percent;
  };
  // Look-up: half an input step (of a range a little above 1) times the steepest slope (.396 at the end of
  // the descending branch), plus half an output step of a hundred-and-twenty-seventh of .089.
  EXPECT_LT(error(PolynomialBy::lookup), 100.0 * (0.396 * 1.06 / 512.0 + 0.09 / 254.0) * 1.15);
  EXPECT_GT(error(PolynomialBy::lookup), 100.0 * 0.3 / 512.0);
  // Multipliers about the middle of the range: the square's coefficient is .05 of the stroke there.
  EXPECT_LT(error(PolynomialBy::multipliers), error(PolynomialBy::lookup));
  // Outside: .1 % of a square and of a cube (twice), and the weights' rounding.
  EXPECT_LT(error(PolynomialBy::outside), 100.0 * (0.6433 + 2.0 * 0.2887) * 0.001 + 0.06);
}

TEST(Controller, LoopLeavesOnlyTheConvertersSteps) {
  const Disturbance d = seed_with_rates();
  const Controller controller = value_or_throw(make_controller(d, {}, {}));
  for (const ControllerVariant& v : controller.variants) {
    if (!v.fits()) continue;
    expect_legal_controller(v);
    const double residue = worst_residue(v, d, 20.0);
    if (v.structure == ControllerStructure::loop) {
      // Twice the greatest step of the table, and what 20 Hz moves in the loop's delay.
      EXPECT_LT(residue, 2.0 * 0.4 / 256.0) << v.name();
    } else if (v.structure == ControllerStructure::two_pass) {
      EXPECT_LT(residue, 0.01) << v.name();
    } else {
      EXPECT_GT(residue, 0.015) << v.name();
    }
  }
}

TEST(Controller, OtherDisturbances) {
  Disturbance d;
  d.ascending = {-0.25, 0.1, 0.05};  // other signs, the loop does not close at 1
  d.descending = {0.1, 0.3, -0.25};
  d.rate.frequency = {{1}, {30}};
  d.rate.ascending = {1, 1.3};
  d.rate.descending = {1, 0.8};
  const Controller controller = value_or_throw(make_controller(d, {}, {}));
  for (const auto by : {PolynomialBy::outside, PolynomialBy::multipliers, PolynomialBy::lookup}) {
    const ControllerVariant& v = variant_of(controller, by, ControllerStructure::loop);
    ASSERT_TRUE(v.fits()) << v.name();
    // The drive goes beyond the stroke, and volts make room for it.
    EXPECT_LT(v.scale.volts(1.1), 3.0);
    EXPECT_LT(worst_residue(v, d, 30.0), 0.006) << v.name();
  }
}

TEST(Controller, ALineFlattensATable) {
  Disturbance d;
  d.ascending = {0.3, -0.05, 0.0};
  d.descending = {0.28, 0.05, 0.0};
  const Controller controller = value_or_throw(make_controller(d, {}, {}));
  const ControllerVariant& v = variant_of(controller, PolynomialBy::lookup, ControllerStructure::loop);
  ASSERT_TRUE(v.fits());
  ASSERT_EQ(v.find("AscendingGain")->inputs.size(), 2u);
  // Without the line half an input step of .3 alone would be .06 %; with it the weights of two capacitors
  // are.
  EXPECT_LT(v.max_error_percent, 0.09);
  EXPECT_LT(worst_residue(v, d, 5.0), 0.0016);
}

TEST(Controller, BranchWithoutDisturbance) {
  Disturbance d;
  d.ascending = {0.2, -0.2, 0.0};
  const Controller controller = value_or_throw(make_controller(d, {}, {}));
  EXPECT_LT(worst_residue(variant_of(controller, PolynomialBy::lookup, ControllerStructure::loop), d, 5.0),
            0.003);
}

TEST(Controller, LoopThatDoesNotSettleIsRefusedInOneLine) {
  Disturbance d = seed_disturbance();
  for (double& a : d.ascending) a *= 3.0;
  ControllerOptions options;
  options.structure = ControllerStructure::loop;
  const Outcome<Controller> outcome = make_controller(d, {}, options);
  const Refusal* refusal = refusal_of(outcome);
  ASSERT_NE(refusal, nullptr);
  EXPECT_THAT(refusal->reason, HasSubstr("|K d'| is 1.0"));
  EXPECT_THAT(refusal->reason, HasSubstr("two-pass"));
  EXPECT_EQ(refusal->reason.find('\n'), std::string::npos);
  // Without the wish another structure is taken.
  EXPECT_NE(value_or_throw(make_controller(d, {}, {})).best().structure, ControllerStructure::loop);
}

TEST(ControllerNetlist, ItsClocksAreThoseOfItsCams) {
  const Controller controller = value_or_throw(make_controller(seed_disturbance(), {}, {}));
  const ControllerVariant& variant = variant_of(controller, PolynomialBy::outside, ControllerStructure::loop);
  std::set<double> wanted, written;
  for (const ControllerCam& cam : variant.cams) wanted.insert(1.0 / cam.clock_a.value);
  const std::string text = controller_netlist(variant, {}, "title");
  for (const auto& found : matches(text, "Vc[0-9]+p1 [^\\n]*PULSE\\([^)]* ([-+.0-9e]+)\\)"))
    written.insert(std::stod(found[1]));
  ASSERT_EQ(written.size(), wanted.size()) << text;
  for (auto a = wanted.begin(), b = written.begin(); a != wanted.end(); ++a, ++b)
    EXPECT_NEAR(*b / *a, 1.0, 1e-9);
}

TEST(Controller, EveryConverterNeedsItsClockB) {
  ControllerOptions options;
  options.fast_clock = {2e6};  // 16 times it is above the master clock
  Disturbance d = seed_disturbance();
  const Controller fast = value_or_throw(make_controller(d, {}, options));
  EXPECT_TRUE(variant_of(fast, PolynomialBy::outside, ControllerStructure::loop).fits());
  EXPECT_FALSE(variant_of(fast, PolynomialBy::lookup, ControllerStructure::loop).fits());
  // Amplitude gains are multipliers, also where the powers come from outside.
  d.amplitude.alpha = {0.5, 1.0};
  d.amplitude.ascending = {0.6, 1.0};
  d.amplitude.descending = {0.6, 1.0};
  const auto outcome = make_controller(d, {}, options);
  const Refusal* refusal = refusal_of(outcome);
  ASSERT_NE(refusal, nullptr);
  EXPECT_THAT(refusal->reason, HasSubstr("ClockB"));
  options.fast_clock = {250e3};
  const Controller slow = value_or_throw(make_controller(d, {}, options));
  const ControllerVariant& v = variant_of(slow, PolynomialBy::lookup, ControllerStructure::loop);
  expect_legal_controller(v);
  EXPECT_NE(v.find("AscendingAmplitude"), nullptr);
  EXPECT_LT(worst_residue(v, d, 5.0), 0.004);
}

TEST(Controller, TwoCompensatorsStillFitAndTooManyAreRefused) {
  const Controller two =
      value_or_throw(make_controller(seed_disturbance(), {&seed_plan(), &seed_plan()}, {}));
  expect_legal_controller(two.best());
  Sections many;
  for (int i = 0; i < 28; ++i)
    many.sections.push_back(Section::pole_zero(1.0, {50.0 + 10.0 * i}, {55.0 + 10.0 * i}));
  PlanOptions options;
  options.clock = Hertz{2000.0};
  const Plan big = plan_of(many, options);
  const Outcome<Controller> outcome = make_controller(seed_disturbance(), {nullptr, &big}, {});
  const Refusal* refusal = refusal_of(outcome);
  ASSERT_NE(refusal, nullptr) << "28 sections and the rest of the controller cannot fit";
  EXPECT_THAT(refusal->reason, HasSubstr("fit"));
  EXPECT_THAT(refusal->reason, HasSubstr("expected"));
}

TEST(Controller, ATablesGainStaysOnTheChipOfTheSwitchThatReadsIt) {
  ControllerOptions options;
  options.polynomial = PolynomialBy::lookup;
  const Controller controller =
      value_or_throw(make_controller(seed_disturbance(), {&seed_plan(), nullptr}, options));
  const ControllerVariant& v = controller.best();
  EXPECT_EQ(v.find("DescendingGain")->chip, v.find("Branch")->chip);
}

TEST(Controller, AskedForWayIsTaken) {
  ControllerOptions options;
  options.polynomial = PolynomialBy::lookup;
  options.structure = ControllerStructure::delayed;
  const Controller controller =
      value_or_throw(make_controller(seed_disturbance(), {nullptr, &seed_plan()}, options));
  EXPECT_EQ(controller.best().by, PolynomialBy::lookup);
  EXPECT_EQ(controller.best().structure, ControllerStructure::delayed);
  options.fast_clock = {3.0};
  EXPECT_NE(refusal_of(make_controller(seed_disturbance(), {}, options)), nullptr);
}

TEST(Controller, IsAPlanWithEveryWire) {
  const Controller controller = value_or_throw(make_controller(seed_with_rates(), {}, {}));
  expect_kept("fpaa/kept_controller.txt",
              controller_sheet(controller) + gain_sets_csv(controller.best(), seed_with_rates()) +
                  line_a_key(controller.to_json()) + "picture " +
                  digest(board_picture_svg(controller_plan(controller.best()))) + "\n");
  for (const ControllerVariant& v : controller.variants) {
    if (!v.fits()) continue;
    const Plan plan = controller_plan(v);
    std::size_t inputs = 0;
    std::set<std::pair<std::string, int>> read;
    for (const ControllerCam& cam : v.cams) inputs += cam.inputs.size();
    for (const Wire& wire : plan.wires) {
      const bool to_pin =
          wire.to.find(".in") != std::string::npos || wire.to.find(".out") != std::string::npos;
      if (!to_pin) read.emplace(wire.to, wire.input);
    }
    EXPECT_EQ(read.size(), inputs) << v.name();
    EXPECT_EQ(plan.cams().size(), v.cams.size());
    for (const ChipPlan& chip : plan.chips) {
      for (const PlacedCam& cam : chip.cams) {
        EXPECT_NEAR(
            chip.clocks.frequency(an231k04_quad4().master_clock, static_cast<std::size_t>(cam.clock_index))
                .value,
            cam.clock_a.value, 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
