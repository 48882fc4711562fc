#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdlib>
#include <map>
#include <ostream>
#include <set>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/seed_sections.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "kept_text.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using ::testing::HasSubstr;

/// The response rebuilt from nothing but the capacitors in plan.json.
Complex from_capacitors(const Plan& plan, double hz) {
  Complex h = 1.0;
  for (const PlacedCam* cam : plan.cams()) {
    std::map<std::string, double> c;
    for (const Capacitor& capacitor : cam->capacitors) c[capacitor.name] = capacitor.units;
    const Complex d = 1.0 - std::exp(Complex(0.0, -2.0 * M_PI * hz / cam->clock_a.value));
    if (cam->option == "Pole and Zero") {
      h *= -(c["Ca"] + c["Cb"] * d) / (c["Cc"] + c["Cd"] * d);
    } else if (cam->option == "Low Pass") {
      h *= -c["Cin"] / (c["Cout"] + c["Cint"] * d);
    } else if (cam->option == "High Pass") {
      h *= -c["Cb"] * d / (c["Cc"] + c["Cd"] * d);
    } else {
      h *= -c["Cin"] / c["Cout"];
    }
  }
  return h;
}

double worst_percent(const Plan& plan, const Sections& sections, double from, double to) {
  double worst = 0.0;
  for (int i = 0; i <= 2000; ++i) {
    const double f = from * std::pow(to / from, i / 2000.0);
    worst = std::max(worst,
                     100.0 * std::abs(from_capacitors(plan, f) / sections.response(Hertz{f}.rad_s()) - 1.0));
  }
  return worst;
}

void expect_legal(const Plan& plan) {
  const Board& board = board_by_name(plan.board);
  std::set<std::string> names;
  for (const ChipPlan& chip : plan.chips) {
    std::map<int, Resources> cabs;
    for (const PlacedCam& cam : chip.cams) {
      EXPECT_TRUE(names.insert(cam.name).second) << cam.name << " twice";
      cabs[cam.cab] += cam.resources;
      for (const Capacitor& c : cam.capacitors) {
        EXPECT_GE(c.units, 1);
        // CA and CB of a two-op-amp stage may have two banks.
        EXPECT_LE(c.units, (c.name == "CA" || c.name == "CB" ? 2 : 1) * kMostUnits);
      }
      EXPECT_DOUBLE_EQ(
          chip.clocks.frequency(board.master_clock, static_cast<std::size_t>(cam.clock_index)).value,
          cam.clock_a.value);
      std::vector<double> a = cam.z.denominator;
      a.resize(3, 0.0);
      EXPECT_TRUE(std::abs(a[2]) < a[0] && std::abs(a[1]) < a[0] + a[2]) << cam.name;  // Jury
    }
    EXPECT_LE(static_cast<int>(cabs.size()), kCabs);
    for (const auto& [cab, used] : cabs) EXPECT_TRUE(used.fits_in(kPerCab)) << "CAB " << cab;
  }
}

TEST(MakePlan, SeedAtTwoKilohertz) {
  PlanOptions options;
  options.clock = Hertz{2000.0};
  const Plan plan = plan_of(seed_sections(), options);
  expect_legal(plan);
  EXPECT_LE(plan.chips.size(), 2u);  // a second chip has to earn a tenth of what 95 % of boards are off
  EXPECT_EQ(plan.topology, "chain");
  for (const PlacedCam* cam : plan.cams()) {
    EXPECT_EQ(cam->cam_name(), "FilterBilinear");
    EXPECT_DOUBLE_EQ(cam->clock_a.value, 2000.0);
  }
  EXPECT_NEAR(plan.error.max_complex_percent,
              worst_percent(plan, seed_sections(), plan.error.band.from.value, plan.error.band.to.value),
              1e-3);
  EXPECT_LE(plan.error.band.from.value, 13.99 / (2.0 * M_PI));
  EXPECT_GE(plan.error.band.to.value, 652.1 / (2.0 * M_PI) * (1.0 - 1e-12));
  // What follows its input through phase 1 and keeps its value through phase 2 is not late.
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 0.6);
  EXPECT_EQ(plan.signal_path().front(), "chip1.in1");
  EXPECT_EQ(plan.signal_path().back(), fmt::format("chip{}.out1", plan.chips.size()));
  EXPECT_FALSE(plan.assumptions.empty());
  EXPECT_GT(plan.max_input_v, 1.2);
}

/// Every key that a plan may have, each of another value.
TEST(MakePlan, JsonReadsBack) {
  Plan plan = seed_plan();
  plan.trade_off = {{0.5, 1.5, 2.5, 3, false}, {0.75, 1.75, 2.75, 4, true}};
  plan.image = {{11.0}, {12.0}, -13.0};
  plan.image_in_band = {{14.0}, {15.0}, -16.0};
  plan.total->image_percent = 0.125;
  plan.notes = {"one", "two"};
  plan.chips[0].pins = {{"in1", "IO1"}, {"out1", "IO3"}};
  Json json = json_header("fpaa_plan", {});
  json.update(plan.to_json());
  const Plan back = Plan::from_node(parse_json(to_text(json), "plan.json"));
  EXPECT_EQ(to_text(back.to_json()), to_text(plan.to_json()));
  const SwitchedBoard written(plan), read(back);
  for (const double f : {0.5, 20.0, 99.0}) {
    EXPECT_EQ(read.gain(Hertz{f}.rad_s()), written.gain(Hertz{f}.rad_s()));
    EXPECT_EQ(read.sampled(Hertz{f}.rad_s()), written.sampled(Hertz{f}.rad_s()));
  }
  // A clock that no divisor makes: its edges within another clock's period would fill any memory.
  json["chips"][0]["cams"][0]["clock_a_hz"] = 1e15;
  EXPECT_THROW(Plan::from_node(parse_json(to_text(json), "plan.json")), InputError);
}

TEST(MakePlan, TotalSignAndGainAreKept) {
  for (const auto& [gain, count] : {std::pair{1.0, 1u}, {-1.0, 2u}, {-0.02, 1u}, {4000.0, 1u}}) {
    Sections sections = seed_sections();
    sections.gain = gain;
    sections.sections.resize(count);
    sections.sections[0].zeros.pop_back();  // a low pass among them
    const Plan plan = plan_of(sections);
    expect_legal(plan);
    const double dc = SwitchedBoard(plan).gain({0.0}).real();
    EXPECT_NEAR(dc / sections.dc_gain(), 1.0, 0.02) << gain;
    EXPECT_LE(plan.error_with_delays.max_complex_percent, 2.0) << gain;
  }
}

TEST(MakePlan, HighPassAndSinglePoleSections) {
  Sections sections;
  Section high;
  high.zeros = {0.0};
  high.poles = {-200.0};
  sections.sections = {high, Section::pole_zero(1.0, {300.0}, {900.0})};
  PlanOptions options;
  options.band = Band{{5.0}, {300.0}};
  const Plan plan = plan_of(sections, options);
  expect_legal(plan);
  EXPECT_EQ(plan.topology, "chain");
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 0.7);
}

TEST(MakePlan, RefusesWithWhatWouldHelp) {
  const auto message = [](const Sections& sections, const PlanOptions& options = {}) -> std::string {
    const Outcome<Plan> outcome = make_plan(sections, options);
    const Refusal* refusal = refusal_of(outcome);
    return refusal == nullptr ? "" : refusal->reason;
  };
  // The vendor has no CAM with a zero in the right half plane.
  PlanOptions chain;
  chain.topology = PlanOptions::Topology::chain;
  Sections right = seed_sections();
  right.sections[1].zeros = {12.0, -3.0};
  EXPECT_THAT(message(right, chain), HasSubstr("AnadigmDesigner2"));

  Sections many;
  for (int i = 0; i < 33; ++i) many.sections.push_back(Section::pole_zero(1.0, {100.0}, {120.0}));
  EXPECT_THAT(message(many), HasSubstr("33 poles need"));

  Sections endless = seed_sections();
  endless.gain = 1e300;
  endless.sections[0].gain = 1e300;
  EXPECT_THAT(message(endless), HasSubstr("not finite"));
  // Refused before any search: the noise of one capacitor would fill the output, or hide it.
  for (const double gain : {1e12, 1e100, 1e-12, 1e-100}) {
    Sections absurd = seed_sections();
    absurd.gain = gain;
    EXPECT_THAT(message(absurd), HasSubstr("beyond what the noise of a capacitor leaves")) << gain;
  }

  Sections fast_pole;
  fast_pole.gain = 1e300;
  fast_pole.sections = {Section{1e300, {}, {-1e300}}};
  EXPECT_THAT(message(fast_pole), HasSubstr("below half the board's clock"));

  PlanOptions odd;
  odd.clock = Hertz{1999.0};
  EXPECT_THAT(message(seed_sections(), odd), HasSubstr("nearest is"));
  PlanOptions fast;
  fast.clock = Hertz{20000.0};
  EXPECT_THAT(message(seed_sections(), fast), HasSubstr("clock"));
  PlanOptions board;
  board.board = "abacus";
  EXPECT_THAT(message(seed_sections(), board), HasSubstr("an231k04-quad4"));
  EXPECT_THAT(message(Sections{}), HasSubstr("no sections"));
}

TEST(MakePlan, ThirtyTwoSectionsComeOnTheBoard) {
  Sections sections;
  for (int i = 0; i < 32; ++i) {
    const double zero = 20.0 * std::pow(1.09, i);
    sections.sections.push_back(Section::pole_zero(1.0, {zero}, {zero * 1.05}));
  }
  PlanOptions options;
  options.clock = Hertz{4000.0};
  const Plan plan = plan_of(sections, options);
  expect_legal(plan);
  EXPECT_EQ(plan.chips.size(), 4u);
  EXPECT_EQ(digest(board_picture_svg(plan)), "12a8fc90e4429a93");
  EXPECT_LE(plan.error_with_delays.max_complex_percent, 1.0);
}

std::string all_said(const Plan& plan) {
  return build_sheet_markdown(plan) + line_a_key(plan.to_json()) + "picture " +
         digest(board_picture_svg(plan)) + "\n";
}

TEST(BuildSheet, NamesEveryCamClockAndCapacitor) {
  const Plan& plan = seed_plan();
  const std::string sheet = build_sheet_markdown(plan);
  for (const PlacedCam* cam : plan.cams()) {
    EXPECT_THAT(sheet, HasSubstr("**" + cam->name + "**"));
    for (const Capacitor& c : cam->capacitors) {
      EXPECT_THAT(sheet, HasSubstr(" " + c.name + " = " + std::to_string(c.units)));
    }
  }
  EXPECT_THAT(sheet, HasSubstr("Chip Clock 0"));
  EXPECT_THAT(sheet, HasSubstr("Output Phase Phase 1"));
  EXPECT_THAT(build_sheet_html(plan), HasSubstr("</html>"));
  expect_kept("fpaa/kept_seed.txt",
              all_said(plan) + "page " + digest(few_digits(build_sheet_html(plan))) + "\n");
}

}  // namespace
}  // namespace bodesmith::fpaa

// Two processors make figures that differ in their last digits: they should find the same plan.
namespace bodesmith::fpaa {
namespace {

/// Gain and roots off by up to 1e-13 of themselves; conjugate and equal ones alike.
Sections a_little_off(Sections sections, int seed) {
  const auto off = [&](double of) { return 1.0 + 1e-13 * std::sin(1e3 * std::log(of) + seed); };
  for (Section& section : sections.sections) {
    section.gain *= off(std::abs(section.gain) + 1.0);
    for (auto* roots : {&section.zeros, &section.poles}) {
      for (auto& root : *roots) root *= root == 0.0 ? 1.0 : off(std::abs(root));
    }
  }
  return sections;
}

std::vector<std::complex<double>> resonance(double hz, double quality) {
  const double w = 2.0 * M_PI * hz;
  const std::complex<double> p(-0.5 * w / quality, w * std::sqrt(1.0 - 0.25 / (quality * quality)));
  return {p, std::conj(p)};
}

struct KeptPlan {
  const char* name;
  Sections sections;
  Band band;
  friend void PrintTo(const KeptPlan& plan, std::ostream* out) { *out << plan.name; }
};

class LastBits : public testing::TestWithParam<KeptPlan> {};

/// The kept texts are those of the sections as they are.
TEST_P(LastBits, DecideNoPartOfAPlan) {
  const auto& [name, sections, band] = GetParam();
  PlanOptions options;
  options.band = band;
  const Plan plan =
      plan_of(std::getenv("BODESMITH_KEEP") != nullptr ? sections : a_little_off(sections, 1), options);
  expect_kept(fmt::format("fpaa/kept_{}.txt", name), all_said(plan));
}

std::vector<KeptPlan> kept_plans() {
  Sections two = seed_sections(), low, high, all_pass;
  two.sections.resize(2);
  const double w = 2.0 * M_PI * 1000.0;
  low.sections = {{w * w, {}, resonance(1000.0, 0.7)}, {0.5 * w, {}, {-0.5 * w}}};
  high.sections = {{1.0, {0.0, 0.0}, resonance(20.0, 1.0)}};
  all_pass.sections = {{-1.0, {w}, {-w}}};
  return {{"two_sections", two, {{1.0}, {100.0}}},
          {"low_pass", low, {{50.0}, {3000.0}}},
          {"high_pass", high, {{5.0}, {200.0}}},
          {"all_pass", all_pass, {{10.0}, {10e3}}}};
}
INSTANTIATE_TEST_SUITE_P(Plans, LastBits, testing::ValuesIn(kept_plans()),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace bodesmith::fpaa
