// Boards designed as they run, judged by the run of their difference equations or by their own z transfers.
#include "fpaa/topology_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "fpaa/board_picture.hpp"
#include "fpaa/build_sheet.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/multirate_response.hpp"
#include "fpaa/plan_limits.hpp"
#include "plan_simulation.hpp"
#include "seed_sections.hpp"

namespace bodesmith::fpaa {
namespace {

using Root = std::complex<double>;

/// Largest |got/wanted - 1| in percent, as the board runs.
double running_error(const Plan& plan, const Sections& sections, Band band) {
  const MultirateResponse response(plan);
  double worst = 0.0;
  for (const Hertz f : log_grid(band, 300)) {
    const RadPerSecond w = f.rad_s();
    worst = std::max(worst, 100.0 * std::abs(response.as_it_runs(w) / sections.response(w) - 1.0));
  }
  return worst;
}

int opamps_used(const Plan& plan) {
  int out = 0;
  for (const ChipPlan& chip : plan.chips) out += chip.resources().opamps;
  return out;
}

/// Clocks of the tree, CABs and chips as the board has them, whole capacitors, z of just these capacitors.
void expect_buildable(const Plan& plan) {
  const Board& board = board_by_name(plan.board);
  for (const ChipPlan& chip : plan.chips) {
    EXPECT_LE(chip.clocks.clocks.size(), 6u);
    EXPECT_TRUE(is_legal_divisor(chip.clocks.sys1_divisor));
    EXPECT_TRUE(is_legal_divisor(chip.clocks.sys2_divisor));
    std::map<int, Resources> cabs;
    std::map<int, std::set<double>> clocks;
    for (const PlacedCam& cam : chip.cams) {
      cabs[cam.cab] += cam.resources;
      clocks[cam.cab].insert(cam.clock_a.value);
      const auto index = static_cast<std::size_t>(cam.clock_index);
      EXPECT_TRUE(is_legal_divisor(chip.clocks.clocks.at(index).divisor));
      EXPECT_NEAR(chip.clocks.frequency(board, index).value / cam.clock_a.value, 1.0, 1e-12);
      for (const Capacitor& c : cam.capacitors) {
        EXPECT_GE(c.units, 1) << cam.name << " " << c.name;
        EXPECT_LE(c.units, c.name == "CA" || c.name == "CB" ? 510 : 255) << cam.name << " " << c.name;
      }
      EXPECT_TRUE(cam.z.is_stable()) << cam.name;
      const auto transfers = cam.cam->transfers(cam, CapacitorUnits(cam.capacitors));
      ASSERT_EQ(transfers.size(), cam.input_count());
      for (std::size_t i = 0; i < transfers.size(); ++i) {
        EXPECT_EQ(transfers[i].in_z().numerator, cam.z_from(i + 1).numerator) << cam.name;
      }
    }
    for (const auto& [cab, used] : cabs) EXPECT_TRUE(used.fits_in(board.per_cab)) << "CAB " << cab;
    for (const auto& [cab, different] : clocks) EXPECT_LE(different.size(), 2u) << "CAB " << cab;
  }
  EXPECT_EQ(refusal_of(plan_graph(plan)), nullptr);
}

const Plan& seed_as_it_runs() {
  static const Plan plan = [] {
    PlanOptions options;
    options.band = Band{{1.0}, {100.0}};
    return plan_of(seed_sections(), options);
  }();
  return plan;
}

TEST(TopologySearch, SeedAsItRuns) {
  const Plan& plan = seed_as_it_runs();
  expect_buildable(plan);
  // 9.2 % and 100 % as a chain at one clock.
  EXPECT_LE(running_error(plan, seed_sections(), {{1.0}, {100.0}}), 0.15);
  EXPECT_LE(running_error(plan, seed_sections(), {{100.0}, {5000.0}}), 0.6);
  EXPECT_NEAR(plan.error_with_delays.max_complex_percent,
              running_error(plan, seed_sections(), {{1.0}, {100.0}}), 0.02);
  EXPECT_LE(opamps_used(plan), 12);
  EXPECT_EQ(plan.signal_path().front(), "chip1.in1");
  EXPECT_EQ(plan.signal_path().back().find("chip1.out"), 0u);
  ASSERT_TRUE(plan.image);
  EXPECT_LT(plan.image->magnitude_db, -20.0);
  for (const Wire& wire : plan.wires) EXPECT_THAT(build_sheet_markdown(plan), ::testing::HasSubstr(wire.to));
  EXPECT_THAT(board_picture_svg(plan), ::testing::HasSubstr("Sum1"));
}

TEST(TopologySearch, SeedRunEdgeByEdge) {
  const Plan& plan = seed_as_it_runs();
  const double f = 97.0;
  const Root ticked = simulated_fundamental(plan, {f}, 0.6, 0.3);
  // The common period of the clocks is too long to wait for: what is left are the ends of the window.
  EXPECT_NEAR(std::abs(ticked / plan_response(plan, Hertz{f}.rad_s(), true) - 1.0), 0.0, 2e-4);
}

TEST(TopologySearch, CornersSixDecadesApart) {
  Sections wide;
  wide.sections = {Section::pole_zero(1.0, {2.0}, {1.0}), Section::pole_zero(1.0, {1e5}, {3e5})};
  const Plan plan = plan_of(wide);
  expect_buildable(plan);
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 1.0);
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

TEST(TopologySearch, ComplexPolesAndZeros) {
  Sections sections;
  sections.sections = {pair_section(1.0, 500.0, 3.0, 700.0, 1.2), pair_section(0.8, 90.0, 0.8, 150.0, 2.0)};
  const Plan plan = plan_of(sections);
  expect_buildable(plan);
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 1.0);
}

TEST(TopologySearch, AllPassBySubtraction) {
  Sections sections;
  Section first;
  first.gain = -1.0;
  first.zeros = {2.0 * M_PI * 100.0};
  first.poles = {-2.0 * M_PI * 100.0};
  sections.sections = {first};
  PlanOptions options;
  options.band = Band{{1.0}, {10000.0}};
  const Plan plan = plan_of(sections, options);
  expect_buildable(plan);
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 0.5);
  EXPECT_NEAR(plan_response(plan, Hertz{1.0}.rad_s(), true).real(), 1.0, 0.01);
  EXPECT_NEAR(plan_response(plan, Hertz{10000.0}.rad_s(), true).real(), -1.0, 0.01);
}

TEST(TopologySearch, NotchIsDeep) {
  Sections sections;
  const double w = 2.0 * M_PI * 50.0;
  sections.sections = {{1.0, {{0.0, w}, {0.0, -w}}, {{-0.2 * w, 0.98 * w}, {-0.2 * w, -0.98 * w}}}};
  PlanOptions options;
  options.band = Band{{5.0}, {500.0}};
  options.topology = PlanOptions::Topology::cascade;
  const Plan plan = plan_of(sections, options);
  expect_buildable(plan);
  double least = 1.0;
  for (const Hertz f : log_grid({{48.0}, {52.0}}, 401)) {
    least = std::min(least, std::abs(plan_response(plan, f.rad_s(), true)));
  }
  EXPECT_LT(least, 2e-3);
}

/// The order-4 fit of examples/a_weighting: complex zeros at 17.6 Hz, 50 dB below what passes at 1 kHz.
Sections a_weighting() {
  const Root low(-29.513282513100787, 106.38226138522134);
  const Root high(-137857.52475538204, 127288.53231465221);
  const Root pole(-62041.95163091147, 30070.070324004242);
  Sections out;
  out.gain = 0.16605;
  out.sections = {{1.0, {low, std::conj(low)}, {-742.7033830263196, -4399.1652409418275}},
                  {1.0, {high, std::conj(high)}, {pole, std::conj(pole)}}};
  return out;
}

TEST(TopologySearch, SlowZerosUnderAFastClock) {
  const Sections sections = a_weighting();
  const Plan plan = plan_of(sections);
  expect_buildable(plan);
  EXPECT_LE(running_error(plan, sections, {{17.6}, {29900.0}}), 1.0);
  EXPECT_NEAR(plan.error_with_delays.max_complex_percent, running_error(plan, sections, {{17.57}, {29863.0}}),
              0.1);
}

TEST(TopologySearch, RefusalSaysWhatWasTried) {
  Sections sections;
  // A resonance of Q 3000 at 60 kHz: below what whole capacitors resolve.
  const double w = 2.0 * M_PI * 6e4;
  for (int i = 0; i < 3; ++i) {
    sections.sections.push_back({w / 3000.0, {0.0}, {{-w / 6000.0, w}, {-w / 6000.0, -w}}});
  }
  const auto made = make_plan(sections, {});
  const Refusal* refusal = refusal_of(made);
  ASSERT_NE(refusal, nullptr);
  EXPECT_THAT(refusal->reason, ::testing::HasSubstr("tried"));
}

TEST(TopologySearch, SixteenPoles) {
  Sections sections;
  for (int i = 0; i < 16; ++i) {
    const double zero = 2.0 * M_PI * 10.0 * std::pow(1.5, i);
    sections.sections.push_back(Section::pole_zero(1.0, {zero}, {zero * (i % 2 == 0 ? 1.2 : 0.85)}));
  }
  const Plan plan = plan_of(sections);
  expect_buildable(plan);
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 1.5);
}

TEST(TopologySearch, NoClockBelowTheLowest) {
  Sections sections;
  sections.sections = {Section::pole_zero(1.0, {2.0 * M_PI * 1.5}, {2.0 * M_PI}),
                       Section::pole_zero(1.0, {2.0 * M_PI * 40.0}, {2.0 * M_PI * 60.0})};
  PlanOptions options;
  options.lowest_clock = Hertz{31400.0};
  const Plan plan = plan_of(sections, options);
  expect_buildable(plan);
  for (const PlacedCam* cam : plan.cams()) EXPECT_GE(cam->clock_a.value, 31400.0 * 0.999);
  for (const ChipPlan& chip : plan.chips) EXPECT_EQ(chip.clocks.sys2_divisor, 1);
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 1.0);
}

TEST(PlanLimits, StepAndSineOfALowPass) {
  Sections sections;
  Section low;
  low.gain = 5.0 * 200.0;
  low.poles = {-200.0};
  sections.sections = {low};
  const Plan plan = plan_of(sections);
  // Gain 5 at DC: 3 V behind .6 V.
  EXPECT_NEAR(plan.max_input_v, 0.6, 0.02);
  EXPECT_NEAR(plan.max_step_v, 0.6, 0.03);
}

}  // namespace
}  // namespace bodesmith::fpaa
