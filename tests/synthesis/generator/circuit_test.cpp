#include "synthesis/generator/circuit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "kept_text.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/files.hpp"
#include "synthesis/generator/made_layout.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::generator {
namespace {

Disturbance seed_disturbance() {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};
  d.descending = {-0.2398, 0.0838, 0.156};
  return d;
}

double horner(const std::vector<double>& a, double x) {
  double out = 0.0;
  for (size_t k = a.size(); k-- > 0;) out = (out + a[k]) * x;
  return out;
}

TEST(Layout, SeedPolynomialsShareTwoMultipliers) {
  const DisturbanceCircuit layout = make_layout(seed_disturbance());
  EXPECT_EQ(layout.multipliers.size(), 2u);
  EXPECT_LT(layout.max_error_percent, 0.04);
  for (const Branch& b : layout.branches) EXPECT_GE(layout.max_error_percent, b.max_error_percent);
  for (const NodeRange& node : layout.nodes) {
    EXPECT_LE(std::max(std::abs(node.lowest_v), std::abs(node.highest_v)), 1.0 + 1e-9) << node.name;
  }
  EXPECT_TRUE(layout.warnings.empty());
}

/// One after the other: the seed's, with amplitude gains, four branches by select lines, and one of degree seven.
TEST(Layout, EveryFileIsTheOneThatWasKept) {
  Disturbance rated = seed_disturbance();
  rated.amplitude.alpha = {0.1, 0.5, 1.0};
  rated.amplitude.ascending = {0.05, 0.45, 1.0};
  rated.amplitude.descending = {0.4, 0.5, 0.8};
  std::string all;
  const auto add = [&](const DisturbanceCircuit& layout) {
    OutputSet files;
    add_layout_files(layout, "a layout",
                     to_json(layout, make_budget(layout), make_timing(layout, {Hertz{10.0}, Hertz{1000.0}})),
                     files);
    all += digests(files) + disturbance_library(layout, "a layout");
  };
  add(make_layout(seed_disturbance()));
  add(make_layout(rated));
  add(layout_of(
      {{"a", {0.2, 0.1}, {}}, {"b", {0.0, 0.4}, {}}, {"c", {-0.3}, {}}, {"d", {0.1, -0.2, 0.1}, {}}}));
  add(layout_of({{"up", {0.1, -0.1, 0.1, -0.1, 0.1, 0.05, 0.05}, {}}}));
  expect_kept("synthesis/kept_layouts.txt", all);
}

TEST(Layout, MultiplierCountsByDegree) {
  // All powers up to the degree: one multiplier a power; the top power alone: an addition chain.
  const int top_alone[] = {0, 0, 1, 2, 2, 3, 3, 4};
  for (int degree = 1; degree <= 7; ++degree) {
    std::vector<double> all(static_cast<size_t>(degree), 0.1), alone(static_cast<size_t>(degree), 0.0);
    alone.back() = 0.3;
    Options options;
    options.scheme = Scheme::named("shared");
    EXPECT_EQ(layout_of({{"up", all, {}}}, options).multipliers.size(), static_cast<size_t>(degree - 1));
    EXPECT_EQ(layout_of({{"up", alone, {}}}, options).multipliers.size(),
              static_cast<size_t>(top_alone[degree]))
        << degree;
  }
}

TEST(Scheme, HasAWordOrTwoToSixPowersAGroup) {
  EXPECT_EQ(Scheme::named("auto").group, Scheme::kAutomatic);
  EXPECT_EQ(Scheme::named("horner").group, Scheme::kHorner);
  EXPECT_EQ(Scheme::named("shared").group, Scheme::kShared);
  for (int group = 2; group <= 6; ++group) EXPECT_EQ(Scheme::named(std::to_string(group)).group, group);
  for (const char* name : {"1", "7", "2.5", "-3", "nan", "both", ""})
    EXPECT_THROW(Scheme::named(name), InputError) << name;
}

TEST(Layout, ExactPartsMakeThePolynomialExactly) {
  Options options;
  options.resistors = synthesis::Series::named("exact");
  for (const std::vector<double>& a :
       std::vector<std::vector<double>>{{0.5},
                                        {-0.5},
                                        {0.2, 0.3, -0.1},
                                        {-0.1, -0.2, -0.3},
                                        {0, 0, 0.4},
                                        {0.3, -0.2, 0.1, 0.2, -0.15, 0.05, 0.02}}) {
    const DisturbanceCircuit layout = layout_of({{"up", a, {}}, {"down", {-0.2, 0.1}, {}}}, options);
    for (int i = 0; i <= 10; ++i) EXPECT_NEAR(layout.realised(0, i / 10.0), horner(a, i / 10.0), 1e-12);
  }
}

TEST(Layout, ABranchThatIsZeroGivesZero) {
  const DisturbanceCircuit layout = layout_of({{"up", {0.0, 0.0, 0.0}, {}}, {"down", {-0.2, 0.1}, {}}});
  EXPECT_EQ(layout.realised(0, 0.7), 0.0);
}

TEST(Layout, EverySchemeMakesThePolynomialWithEveryNodeInFullScale) {
  Options options;
  options.resistors = synthesis::Series::named("exact");
  const std::vector<std::vector<double>> all = {{0.5},
                                                {0.3, -0.2, 0.1, 0.2, -0.15, 0.05, 0.02},
                                                {0, 0, 0, 0, 0, 0, 0.4},
                                                {0.2, 0, 0, -0.3, 0, 0, 0},
                                                {3.0, -9.0, 4.0, 2.0},
                                                {0, 0, 0}};
  for (int group = 1; group <= 7; ++group) {
    options.scheme = {group};
    for (const std::vector<double>& a : all) {
      const DisturbanceCircuit layout = layout_of({{"up", a, {}}, {"down", {-0.2, 0.1, 0.1}, {}}}, options);
      for (const NodeRange& node : layout.nodes) {
        if (node.name == "out") continue;
        EXPECT_LE(std::max(std::abs(node.lowest_v), std::abs(node.highest_v)), 1.0 + 1e-9)
            << node.name << ", group " << group;
      }
      const RestWiring wiring(layout);
      const AtRest rest(wiring, Deviations::none(layout));
      for (size_t b = 0; b < 2; ++b) {
        const std::vector<double> d = curve(rest, b, {0.0, 0.3, 0.7, 1.0});
        EXPECT_NEAR(d[0], 0.0, 1e-12);
        // What the open contact leaks is some 1e-9 V.
        EXPECT_NEAR(d[1], horner(layout.branches[b].wanted, 0.3), 1e-8) << "group " << group;
        EXPECT_NEAR(d[2], horner(layout.branches[b].wanted, 0.7), 1e-8) << "group " << group;
        EXPECT_NEAR(d[3], horner(layout.branches[b].wanted, 1.0), 1e-8) << "group " << group;
      }
    }
  }
}

TEST(Layout, OfAnyFullScaleItMakesThePolynomial) {
  Options options;
  options.resistors = synthesis::Series::named("exact");
  for (const double full : {0.5, 1.0, 2.5}) {
    options.full_scale_v = full;
    const DisturbanceCircuit layout =
        layout_of({{"up", {0.2, 0.3, -0.1}, {}}, {"down", {-0.2, 0.1}, {}}}, options);
    const RestWiring wiring(layout);
    const AtRest rest(wiring, Deviations::none(layout));
    for (size_t b = 0; b < 2; ++b) {
      const std::vector<double> d = curve(rest, b, {0.3, 1.0});
      EXPECT_NEAR(d[0], horner(layout.branches[b].wanted, 0.3), 1e-8) << full;
      EXPECT_NEAR(d[1], horner(layout.branches[b].wanted, 1.0), 1e-8) << full;
    }
  }
}

TEST(Layout, ReadsBranchesAndNamesWhatIsWrongInThem) {
  const auto read = [](const std::string& rest) {
    return Input::from_node(parse_json(R"({"schema": "bodesmith.disturbance/1", )" + rest + "}", "d.json"));
  };
  const Input two = read(R"("amplitude": {"alpha": [0.5, 1]}, "branches": [{"coefficients": [0.1, 0.2]},
    {"name": "down", "coefficients": [-0.3], "amplitude": [0.4, 1]}])");
  ASSERT_EQ(two.branches.size(), 2u);
  EXPECT_EQ(two.branches[0].name, "branch 1");
  EXPECT_EQ(two.branches[0].coefficients, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(two.branches[1].name, "down");
  EXPECT_EQ(two.branches[1].amplitude, (std::vector<double>{0.4, 1.0}));
  EXPECT_EQ(two.alpha, (std::vector<double>{0.5, 1.0}));
  for (const auto& [wrong, said] : std::vector<std::pair<std::string, std::string>>{
           {R"("branches": [])", "has 0 branches"},
           {R"("branches": [{"coefficients": []}])", "has 0 numbers"},
           {R"("branches": [{"coefficients": [1,1,1,1,1,1,1,1]}])", "has 8 numbers"},
           {R"("branches": [{"coefficients": [1], "gain": 2}])", "is not known here"},
           {R"("branches": [{"coefficients": [1], "amplitude": [1]}])", "has 1 gains"},
           {R"("amplitude": {"alpha": []}, "branches": [{"coefficients": [1]}])", "is empty"},
           {R"("amplitude": {"alpha": [0, 1]}, "branches": [{"coefficients": [1]}])", "out of order"},
           {R"("amplitude": {"alpha": [0.5, 0.5]}, "branches": [{"coefficients": [1]}])", "out of order"}}) {
    try {
      read(wrong);
      FAIL() << wrong;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("d.json:1: "), std::string::npos) << error.what();
    }
  }
}

TEST(Layout, CountsOfTheSchemes) {
  // g powers to a group: g - 1 shared multipliers and (ceil(n/g) - 1) a branch.
  for (int degree = 1; degree <= 7; ++degree) {
    const std::vector<double> a(static_cast<size_t>(degree), 0.1);
    for (size_t branches : {1u, 2u}) {
      const DisturbanceCircuit layout = layout_of(std::vector<Polynomial>(branches, Polynomial{"b", a, {}}));
      ASSERT_EQ(layout.candidates.size(), static_cast<size_t>(degree));
      for (const Candidate& one : layout.candidates) {
        const int groups = (degree + one.group - 1) / one.group;
        EXPECT_EQ(one.multipliers, one.group - 1 + static_cast<int>(branches) * (groups - 1))
            << degree << " by " << one.group;
      }
      const auto chosen = std::find_if(layout.candidates.begin(), layout.candidates.end(),
                                       [](const Candidate& one) { return one.chosen; });
      ASSERT_NE(chosen, layout.candidates.end());
      EXPECT_EQ(static_cast<int>(layout.multipliers.size()), chosen->multipliers);
    }
  }
}

/// Fewest multipliers, then op-amps, then least error among those whose error is at most 1.5 times the least and whose path is 20
/// times as fast as the reference; the most accurate where none is.
TEST(Layout, TheSchemeChosenIsTheCheapestThatIsGoodEnough) {
  std::set<bool> met;
  for (int degree = 3; degree <= 7; ++degree) {
    const Polynomial wave{"b", std::vector<double>(static_cast<size_t>(degree), 0.1), {}};
    for (const double highest : {1e3, 3e5, 1e6, 3e6, 1e9}) {
      Options options;
      options.highest = Hertz{highest};
      const std::vector<Candidate> all = layout_of({wave, wave}, options).candidates;
      double least = INFINITY;
      for (const Candidate& one : all) least = std::min(least, one.rss_percent);
      std::vector<std::tuple<int, int, double>> good, accurate;
      std::optional<std::tuple<int, int, double>> chosen;
      for (const Candidate& one : all) {
        const std::tuple rank(one.multipliers, one.opamps, one.rss_percent);
        if (one.rss_percent == least) accurate.push_back(rank);
        if (one.rss_percent <= 1.5 * least && one.bandwidth.value >= 20.0 * highest) good.push_back(rank);
        if (one.chosen) {
          EXPECT_FALSE(chosen.has_value());
          chosen = rank;
        }
      }
      met.insert(good.empty());
      const auto& from = good.empty() ? accurate : good;
      EXPECT_EQ(chosen, *std::min_element(from.begin(), from.end())) << degree << " at " << highest;
    }
  }
  EXPECT_EQ(met.size(), 2u);
}

TEST(Layout, BranchesAreChosenInPairs) {
  const Polynomial one{"b", {0.1, -0.1}, {}};
  const DisturbanceCircuit five = layout_of(std::vector<Polynomial>(5, one));
  EXPECT_EQ(five.select_lines(), 2);
  EXPECT_EQ(five.branch_at(0, true), 0);
  EXPECT_EQ(five.branch_at(1, false), 3);
  EXPECT_EQ(five.branch_at(2, true), 4);
  EXPECT_EQ(five.branch_at(2, false), 4);
  EXPECT_EQ(five.branch_at(3, true), -1);
  EXPECT_EQ(five.multipliers.size(), 1u);
  EXPECT_EQ(layout_of({one, one}).select_lines(), 0);
}

TEST(Layout, AmplitudeGainsFollowTheirTable) {
  Disturbance d = seed_disturbance();
  d.amplitude.alpha = {0.1, 0.25, 0.5, 0.75, 1.0};
  d.amplitude.ascending = {0.05, 0.2, 0.45, 0.7, 1.0};
  d.amplitude.descending = {0.4, 0.3, 0.5, 0.9, 0.8};
  const DisturbanceCircuit layout = make_layout(d);
  ASSERT_TRUE(layout.amplitude.has_value());
  EXPECT_LT(layout.amplitude->max_error_percent, 0.15);
  EXPECT_GT(layout.amplitude->max_error_percent, 0.01);  // values of a series
  const RestWiring wiring(layout);
  const AtRest rest(wiring, Deviations::none(layout));
  for (const double alpha : {0.05, 0.1, 0.3, 0.62, 0.9, 1.0}) {
    // Below its first stroke the layout holds the gain.
    const double gain = d.amplitude.at(Disturbance::Branch::descending, std::max(alpha, 0.1));
    EXPECT_NEAR(curve(rest, 1, {0.7}, alpha)[0], gain * d.value(Disturbance::Branch::descending, 0.7), 1e-3)
        << alpha;
  }
  // Whatever a multiplier reads or makes is within full scale.
  for (const NodeRange& node : layout.nodes) {
    for (const Multiplier& m : layout.multipliers) {
      if (node.name != m.x && node.name != m.y && node.name != m.out) continue;
      EXPECT_LE(std::max(std::abs(node.lowest_v), std::abs(node.highest_v)), 1.0 + 1e-9) << node.name;
    }
  }
  const Budget budget = make_budget(layout);
  // Offset of a gain multiplier's output weighs 1/branch_gain in d.
  const auto line = std::find_if(budget.lines.begin(), budget.lines.end(),
                                 [](const BudgetLine& one) { return one.cause == "Mha, offset of W"; });
  ASSERT_NE(line, budget.lines.end());
  EXPECT_NEAR(line->percent[0], 100.0 * budget.errors.multiplier_output_v / layout.branch_gain, 1e-7);
  // What stands beside it for full strokes has no such multiplier.
  ASSERT_NE(layout.of_full_strokes, nullptr);
  EXPECT_EQ(layout.of_full_strokes->multipliers.size() + 2, layout.multipliers.size());
}

TEST(Layout, AmplitudeGainsThatVanishOrChangeTheirSignAreMadeByTheProductAlone) {
  const std::vector<Polynomial> branches = {{"up", {0.3, -0.2, 0.1}, {0.0, 1.0}},
                                            {"down", {-0.2, 0.2, 0.1}, {-0.2, 0.6}},
                                            {"constant", {0.1, 0.1}, {0.5, 0.5}}};
  const DisturbanceCircuit layout = make_layout(Input{branches, {0.5, 1.0}});
  EXPECT_EQ(layout.amplitude->multipliers.size(), 2u);
  EXPECT_EQ(layout.branches[0].amplitude.direct, 0.0);
  const RestWiring wiring(layout);
  const AtRest rest(wiring, Deviations::none(layout));
  for (std::size_t b = 0; b < branches.size(); ++b) {
    for (const double alpha : {0.4, 0.5, 0.8, 1.0}) {
      const double along = std::clamp((alpha - 0.5) / 0.5, 0.0, 1.0);
      const std::vector<double>& gain = branches[b].amplitude;
      EXPECT_NEAR(curve(rest, b, {0.6}, alpha)[0],
                  (gain[0] + along * (gain[1] - gain[0])) * horner(branches[b].coefficients, 0.6), 1e-3)
          << b << ", " << alpha;
    }
  }
}

TEST(Budget, CausesByHand) {
  Options options;
  PartErrors errors;
  errors.multiplier_output_v = 10e-3;
  errors.opamp_offset_share = 1e-3 / options.opamp.offset_v;
  options.resistors = synthesis::Series::named("exact");
  const DisturbanceCircuit layout = make_layout(seed_disturbance(), options);
  const Budget budget = make_budget(layout, errors);
  const auto cause = [&](const Budget& of, const std::string& name) {
    for (const BudgetLine& line : of.lines) {
      if (line.cause == name) return line.percent;
    }
    return std::vector<double>{};
  };
  // 10 mV at the output of M3 weigh a3 U^2 in d.
  const auto w3 = cause(budget, "M3, offset of W");
  ASSERT_EQ(w3.size(), 2u);
  EXPECT_NEAR(w3[0], 100.0 * 0.01 * 0.2887 * 1.05 * 1.05, 1e-9);
  EXPECT_NEAR(w3[1], 100.0 * 0.01 * 0.156 * 1.05 * 1.05, 1e-9);
  // The output amplifier's offset comes with its noise gain.
  EXPECT_NEAR(cause(budget, "U3, offset")[0], 100.0 * 1e-3 * (1.0 + 1.0 / layout.branch_gain), 1e-9);
  EXPECT_GE(budget.worst_percent[0], budget.rss_percent[0]);
  // In Horner's scheme the last product's offset is 10 mV/branch_gain of d.
  options.scheme = Scheme::named("horner");
  const DisturbanceCircuit chain = make_layout(seed_disturbance(), options);
  EXPECT_EQ(chain.multipliers.size(), 4u);
  const auto last = cause(make_budget(chain, errors), "Ma0, offset of W");
  ASSERT_EQ(last.size(), 2u);
  // The other branch's contact leaks.
  EXPECT_NEAR(last[0], 100.0 * 0.01 / chain.branch_gain, 1e-8);
  EXPECT_NEAR(last[1], 0.0, 1e-8);
}

TEST(LayoutSwitch, OneTimeConstantMakesBothDelays) {
  SwitchModel model;
  model.on_delay_s = 120e-9;
  model.gap_s = 30e-9;
  const SwitchTimer timer = SwitchTimer::of(model);
  EXPECT_NEAR(1.0 - std::exp(-120e-9 / timer.tau_s), timer.level, 1e-9);
  EXPECT_NEAR(std::exp(-90e-9 / timer.tau_s), timer.level, 1e-9);
  model.gap_s = 120e-9;
  EXPECT_THROW(SwitchTimer::of(model), DesignError);
}

TEST(Timing, GlitchAndDetectorByHand) {
  const DisturbanceCircuit layout = make_layout(seed_disturbance());
  const Timing timing = make_timing(layout, {Hertz{5000}});
  const double swing = layout.other_opamps.at(0).swing_v;
  const double rh1 = layout.part_named("Rh1")->realised, rh2 = layout.part_named("Rh2")->realised;
  EXPECT_NEAR(timing.detector.threshold_v, swing * rh1 / (rh1 + rh2), 1e-12);
  // An op-amp much faster than the gap shows the bare charge: Rg/Rin Q/C.
  DisturbanceCircuit fast = layout;
  fast.opamp.gain_bandwidth = Hertz{10e9};
  fast.analog_switch.gap_s = 5e-9;
  const double bare = fast.part(fast.passes.back().output.feedback).realised /
                      fast.part(fast.passes.back().output.disturbance).realised *
                      fast.analog_switch.charge_c / (2.0 * fast.analog_switch.drain_f);
  EXPECT_NEAR(switch_glitch_v(fast, 0.0, 1.0), bare, 0.03 * bare);
  // Late by the detector and the switch; the step is what the branches differ by then.
  ASSERT_EQ(timing.analog_switch.late.size(), 1u);
  const SwitchFigures::Late& late = timing.analog_switch.late[0];
  ASSERT_TRUE(timing.detector.delays[0].triangle_s.has_value());
  EXPECT_NEAR(late.delay_s, *timing.detector.delays[0].triangle_s + layout.analog_switch.on_delay_s, 1e-12);
  const double moved = 2.0 * 5000.0 * late.delay_s;
  const auto apart = [&](double x) {
    return 100.0 * std::abs(layout.realised(0, x) - layout.realised(1, x));
  };
  EXPECT_NEAR(late.step_percent, std::max(apart(moved), apart(1.0 - moved)), 1e-9);
}

TEST(Layout, RefusesWhatItCannotMake) {
  EXPECT_THROW(layout_of({}), DesignError);
  EXPECT_THROW(layout_of({{"a", std::vector<double>(8, 0.1), {}}}), DesignError);
  EXPECT_THROW(layout_of({{"a", {NAN}, {}}}), DesignError);
  // A term that no resistor makes, and that does nothing, is left out (it was refused).
  EXPECT_LT(layout_of({{"a", {0.5, 1e-9}, {}}}).max_error_percent, 0.05);
  // 1 V stands for d = 1: no op-amp reaches 300 V.
  EXPECT_THROW(layout_of({{"a", {300.0}, {}}}), DesignError);
  EXPECT_THROW(Scheme::named("9"), InputError);
  // With U = 0.5 V x^3 would be 4 V, beyond the multiplier's 2.5 V; Horner's products stay within.
  Options small;
  small.multiplier.scale_v = 0.5;
  small.scheme = Scheme::named("shared");
  EXPECT_THROW(make_layout(seed_disturbance(), small), DesignError);
  small.scheme = Scheme::named("horner");
  EXPECT_EQ(make_layout(seed_disturbance(), small).multipliers.size(), 4u);
}

}  // namespace
}  // namespace bodesmith::generator
