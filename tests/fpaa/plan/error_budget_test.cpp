#include "fpaa/plan/error_budget.hpp"
#include "base/documents/json.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/plan_limits.hpp"
#include "fpaa/seed_sections.hpp"
#include "texts.hpp"

namespace bodesmith::fpaa {
namespace {

TEST(ErrorBudget, PartsOfTheSeedsPlan) {
  const Plan& plan = seed_plan();
  const ErrorBudget budget = error_budget(plan, seed_sections(), {});
  ASSERT_EQ(budget.cams.size(), 8u);
  for (const auto& cam : budget.cams) {
    EXPECT_LT(cam.settling_product_hz, budget.settling_limit_hz);
    EXPECT_GT(cam.noise_kt_per_cu, cam.noise_in_band_kt_per_cu);
  }
  EXPECT_NEAR(plan.max_input_v * std::max(1.0, budget.cams[0].peak_node_gain), 3.0, 1.5);
  const Headroom headroom = headroom_of(SwitchedBoard(plan), plan, plan.error.band);
  EXPECT_EQ(plan.max_input_v, std::min(headroom.sine_v, headroom.step_v));
  EXPECT_EQ(plan.max_step_v, headroom.step_v);
  Plan late = plan;
  late.slow.opamp = schematic::OpAmpModel::one_pole({1e4}, 1e3);
  const ErrorBudget slow = error_budget(late, seed_sections(), {});
  double settling = 0.0;
  for (const auto& cam : slow.cams) settling += cam.settling_percent;
  EXPECT_GT(settling, 0.1);
  EXPECT_DOUBLE_EQ(slow.settling_percent, settling);
  // Of a plan that knows its parts the figure as it runs has them; of one that does not a line says what they would make.
  EXPECT_EQ(late_text(late, slow.late), unsettled_text(late) + "\n");
  EXPECT_EQ(unsettled_text(plan), "") << "it knows no parts";
  late.slow = SlowParts::typical();
  EXPECT_EQ(late_text(late, slow.late), "") << "they settle";
  EXPECT_EQ(late_text(plan, budget.late), "");
  EXPECT_EQ(
      late_text(plan, {SlowParts::typical(), 2.0, {50.0}}),
      "op-amps of 20 MHz and switches of 1 kohm (not published, not in it) would make it 2 % at 50 Hz\n");
}

// A peak of 5 dB at 9 kHz to 20 kHz: what late parts take off a design that knows nothing of them, one that knows them has made up for.
TEST(LateParts, AreMadeUpForWhereTheyAreKnown) {
  const double w = 2.0 * std::numbers::pi * 9e3;
  const auto pair = [&](double q) {
    const Complex root = std::polar(w, std::numbers::pi - std::acos(0.5 / q));
    return std::vector<Complex>{root, std::conj(root)};
  };
  Sections sections;
  sections.sections = {{1.0, pair(1.5), pair(2.67)}};
  PlanOptions options;
  options.quick = true;
  options.band = Band{{1e3}, {20e3}};
  const Plan at_once = value_or_throw(make_plan(sections, options));
  const LateFigure late = late_figure(at_once, sections);
  EXPECT_GT(late.percent, 0.3 + at_once.error_with_delays.max_complex_percent);
  options.assumptions.slow = late.parts;
  const Plan known = value_or_throw(make_plan(sections, options));
  EXPECT_LT(known.error_with_delays.max_complex_percent, 0.5 * late.percent);
  EXPECT_NEAR(late_figure(known, sections).percent, known.error_with_delays.max_complex_percent, 0.01);
}

// One board that is told of other capacitors again and again, and one that is made of them.
TEST(SwitchedBoard, KnowsNothingOfTheCapacitorsItHadBefore) {
  const Plan& plan = seed_plan();
  SwitchedBoard moved(plan);
  std::vector<double> units = moved.nominal_units();
  const RadPerSecond w = Hertz{30.0}.rad_s();
  const std::complex<double> nominal = moved.gain(w);
  for (std::size_t c = 0; c < units.size(); ++c) {
    units[c] += c % 2 == 0 ? 3.0 : -2.0;
    moved.set_units(units);
    if (c % 5 != 0) continue;
    SwitchedBoard fresh(plan);
    fresh.set_units(units);
    EXPECT_EQ(moved.gain(w), fresh.gain(w)) << moved.names()[c];
    EXPECT_NE(moved.gain(w), nominal);
  }
  moved.set_units(moved.nominal_units());
  EXPECT_EQ(moved.gain(w), nominal);
}

TEST(ErrorBudget, MismatchOfOneGainStageIsTheRatiosSpread) {
  Plan plan;
  plan.board = "an231k04-quad4";
  PlacedCam gain;
  gain.name = "Gain1";
  gain.cam = cam_registry().find("GainInv");
  gain.clock_a = {2000.0};
  gain.capacitors = {{"Cin", 100}, {"Cout", 100}};
  gain.z = {{{-100.0}}, {100.0}};
  plan.chips = {{1, {16e6}, {}, {gain}}};
  plan.wires = {{"chip1.in1", "chip1.Gain1"}, {"chip1.Gain1", "chip1.out1"}};
  plan.error.band = {{1.0}, {100.0}};
  Sections unity;
  unity.gain = -1.0;
  plan.error_with_delays.band = plan.error.band;
  BoardAssumptions assumptions;
  const auto moved = [&] {
    return plan_total(plan, SwitchedBoard(plan), unity, assumptions).mismatch_p95_percent;
  };
  const double p95 = moved();
  // 100 units: 0.05 % each, the ratio sqrt(2) of it. |N(0, sigma)|: 95 % below 1.960 sigma; of 5000 boards known to 1 %.
  EXPECT_NEAR(p95 / (1.960 * 0.05 * std::sqrt(2.0)), 1.0, 0.04);
  EXPECT_EQ(moved(), p95);
  assumptions.seed = 2;
  EXPECT_NE(moved(), p95);
  const ErrorBudget budget = error_budget(plan, unity, assumptions);
  EXPECT_NEAR(budget.capacitors[0].share, 0.5, 1e-3);
}

/// 2 kT C a sample through 1/(A - B/z), sum h^2 = 1/(A^2 - B^2), less what the op-amp gives back to Cout and what lies
/// beyond half the clock.
TEST(ErrorBudget, NoiseOfALowPassIsSomewhatBelowTwoChargesASample) {
  Plan plan;
  plan.board = "an231k04-quad4";
  PlacedCam filter;
  filter.name = "Section1";
  filter.cam = cam_registry().find("FilterBilinear");
  filter.option = "Low Pass";
  filter.clock_a = {2000.0};
  filter.capacitors = {{"Cin", 6}, {"Cint", 50}, {"Cout", 4}};
  filter.z = {{{-6.0}}, {54.0, -50.0}};
  filter.requested = {{"corner_hz", 20.0}, {"gain", 1.5}};
  plan.chips = {{1, {16e6}, {}, {filter}}};
  plan.wires = {{"chip1.in1", "chip1.Section1"}, {"chip1.Section1", "chip1.out1"}};
  plan.error.band = {{1.0}, {100.0}};
  Sections sections;
  sections.gain = -1.0;
  const ErrorBudget budget = error_budget(plan, sections, {});
  const double two_charges = 2.0 * 10.0 / (54.0 * 54.0 - 50.0 * 50.0);
  EXPECT_LT(budget.noise_kt_per_cu, two_charges);
  EXPECT_GT(budget.noise_kt_per_cu, 0.8 * two_charges);
  // sqrt(kT/C) of 50 fF at 300 K is 287.8 uV.
  EXPECT_NEAR(budget.assumptions.noise.microvolts(1.0), 287.8, 0.1);
}

TEST(ErrorBudget, SaysWhatItIsMadeOf) {
  ErrorBudget budget;
  for (int i = 1; i <= 9; ++i) budget.capacitors.push_back({fmt::format("C{}", i), 1.0 / i});
  budget.assumptions = {{0.25, 0.125}, {2e-15, 400.0}, {}, 5};
  budget.cams = {{"A", 1.5, 2.5, 3.5, 4.0, 4.5, 5.5}};
  budget.settling_limit_hz = 6.5;
  budget.noise_kt_per_cu = 16.0;
  budget.noise_in_band_kt_per_cu = 9.0;
  budget.settling_percent = 10.5;
  budget.late = {{schematic::OpAmpModel::one_pole({8.5}, 9.5)}, 11.5, {12.5}};
  Json json = budget.to_json();
  ASSERT_EQ(json["mismatch"]["capacitors"].size(), 8u);
  EXPECT_EQ(json["mismatch"]["capacitors"][7], parsed(R"({"capacitor": "C8", "share": 0.125})"));
  json["mismatch"].erase("capacitors");
  // sqrt(kT/C) of one unit, in uV.
  const double unit_uv = 1e6 * std::sqrt(1.380649e-23 * 400.0 / 2e-15);
  EXPECT_NEAR(json["noise_uv"].get<double>(), 4.0 * unit_uv, 1e-9 * unit_uv);
  EXPECT_NEAR(json["noise_in_band_uv"].get<double>(), 3.0 * unit_uv, 1e-9 * unit_uv);
  for (const char* key : {"noise_uv", "noise_in_band_uv"}) json.erase(key);
  EXPECT_EQ(json, parsed(R"({
      "mismatch": {"seed": 5, "draws": 5000},
      "settling_limit_hz": 6.5, "settling": {"opamp_gain_bandwidth_hz": 8.5, "opamp_gain": 9.5, "late_percent": 11.5, "error_percent": 10.5},
      "noise_kt_per_cu": 16, "noise_in_band_kt_per_cu": 9, "noise": {"unit_capacitance_f": 2e-15, "temperature_k": 400},
      "cams": [{"name": "A", "gain": 1.5, "settling_product_hz": 2.5, "settling_percent": 5.5, "peak_node_gain": 3.5,
                "noise_kt_per_cu": 4, "noise_in_band_kt_per_cu": 4.5}]})"));
}

}  // namespace
}  // namespace bodesmith::fpaa
