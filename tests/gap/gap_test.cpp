// What ngspice measures on decks of op-amps, capacitors, switches, multipliers and diodes, and what the
// search makes of it.
#include <gtest/gtest.h>

#include <cmath>

#include "base/documents/document.hpp"
#include "chain/model_file.hpp"
#include "gap/cases/expect.hpp"
#include "gap/cases/response_cases.hpp"
#include "gap/cases/signals.hpp"
#include "gap/cases/spice_cases.hpp"
#include "gap/records/settling.hpp"
#include "gap/search.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace bodesmith;
using hidden::Hidden;
using hidden::Kind;
using hidden::World;

constexpr std::size_t kMeasuredRows = 1000;

class Measured : public testing::TestWithParam<Hidden> {
 protected:
  void SetUp() override {
    if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed: nothing to measure with";
  }
};

// The decks themselves: with nothing hidden they are their models to far below the noise that is added later.
class CleanDeck : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!ngspice::is_available()) GTEST_SKIP() << "ngspice is not installed: nothing to measure with";
  }
};
TEST_P(CleanDeck, IsItsModel) {
  const auto deck = hidden::make_clean_deck(GetParam(), 11, 1000);
  const auto chain = chain::model_from_node(parse_toml(deck.model, "model.toml"));
  simulate::Options options;
  options.start = simulate::Start::equilibrium;  // as ngspice begins
  const auto model = simulate::simulate(chain, deck.record, options).y;
  const auto start = gap::start_samples(chain, deck.record);
  std::vector<double> scored;
  std::vector<double> error;
  for (std::size_t i = start; i < model.size(); ++i) {
    scored.push_back(deck.record.y[i]);
    error.push_back(model[i] - deck.record.y[i]);
  }
  EXPECT_LT(hidden::rms(error), 1e-3 * hidden::rms(scored)) << "leaves out " << start;
}
INSTANTIATE_TEST_SUITE_P(Decks, CleanDeck, testing::ValuesIn(hidden::spice_bases()),
                         [](const auto& test) { return test.param; });

using MeasuredEffect = Measured;
TEST_P(MeasuredEffect, IsNamed) {
  hidden::expect_right(World::ngspice, Kind::effect, GetParam(), kMeasuredRows);
}
INSTANTIATE_TEST_SUITE_P(Decks, MeasuredEffect,
                         testing::Values(Hidden{"opamp_gain", "slew_limit", 3},
                                         Hidden{"opamp_gain", "saturation", 4},
                                         Hidden{"multipliers", "multiplier_error", 5},
                                         Hidden{"switched", "switch_delay", 6},
                                         Hidden{"opamp_gain", "sample_hold", 7}),
                         hidden::HiddenName());

using MeasuredSection = Measured;
TEST_P(MeasuredSection, IsNamedAndItsGapCloses) {
  const auto outcome = hidden::expect_right(World::ngspice, Kind::effect, GetParam(), kMeasuredRows);
  EXPECT_GT(outcome.closure, 0.8) << hidden::line_of(outcome);
}
INSTANTIATE_TEST_SUITE_P(Decks, MeasuredSection,
                         testing::Values(Hidden{"opamp_sections", "opamp_bandwidth", 1},
                                         Hidden{"opamp_sections", "capacitor_mismatch", 2}),
                         hidden::HiddenName());

using MeasuredControl = Measured;
TEST_P(MeasuredControl, IsLeftAlone) {
  hidden::expect_right(World::ngspice, Kind::control, GetParam(), kMeasuredRows);
}
INSTANTIATE_TEST_SUITE_P(Decks, MeasuredControl, testing::Values(Hidden{"opamp_sections", "coloured", 8}),
                         hidden::HiddenName());

using MeasuredOutsider = Measured;
TEST_P(MeasuredOutsider, IsNotInTheCatalogue) {
  hidden::expect_right(World::ngspice, Kind::outside, GetParam(), kMeasuredRows,
                       {.max_terms = hidden::kOutsiderTerms});
}
INSTANTIATE_TEST_SUITE_P(Decks, MeasuredOutsider, testing::Values(Hidden{"opamp_gain", "diode", 9}),
                         hidden::HiddenName());

}  // namespace

namespace {

using namespace bodesmith;
using hidden::Hidden;
using hidden::Kind;
using hidden::World;

/// A base, and the linear effects on it that responses tell.
std::vector<Hidden> effects_on_every_base() {
  std::vector<Hidden> all;
  for (const auto& base : hidden::response_bases()) {
    for (const auto& effect : hidden::response_effects(base)) {
      // Not looked for in responses, and three relaxations that one fractional term imitates.
      if (effect == "sample_hold" || effect == "creep") continue;
      if (base == "sections" && effect == "resonance") continue;  // the fit may end in a side minimum
      all.push_back({base.c_str(), effect.c_str(), 2});
    }
  }
  return all;
}

class EffectInResponse : public testing::TestWithParam<Hidden> {};
TEST_P(EffectInResponse, IsNamedAndItsGapCloses) {
  const auto outcome = hidden::expect_right(World::responses, Kind::effect, GetParam(), 0);
  EXPECT_GT(outcome.closure, 0.8) << hidden::line_of(outcome);
}
INSTANTIATE_TEST_SUITE_P(FrequencyResponse, EffectInResponse, testing::ValuesIn(effects_on_every_base()),
                         hidden::HiddenName());

/// Five controls of every kind on every base, each with a seed of its own.
constexpr std::uint64_t kControlsOfAKind = 5;
std::vector<Hidden> controls_on_every_base() {
  std::vector<Hidden> all;
  std::uint64_t seed = 40;
  for (const auto& base : hidden::response_bases()) {
    for (const auto& kind : hidden::response_control_kinds())
      all.push_back({base.c_str(), kind.c_str(), ++seed});
  }
  return all;
}

class ControlInResponse : public testing::TestWithParam<Hidden> {};
TEST_P(ControlInResponse, IsLeftAlone) {
  const std::uint64_t between = hidden::response_bases().size() * hidden::response_control_kinds().size();
  Hidden control = GetParam();
  for (std::uint64_t repeat = 0; repeat < kControlsOfAKind; ++repeat, control.seed += between)
    hidden::expect_right(World::responses, Kind::control, control, 0);
}
INSTANTIATE_TEST_SUITE_P(FrequencyResponse, ControlInResponse, testing::ValuesIn(controls_on_every_base()),
                         hidden::HiddenName());

TEST(FrequencyResponse, ADelaysValueIsFound) {
  const auto c = hidden::make_case({World::responses, Kind::effect, "gain", {"time_delay"}, 50.0, 5});
  const auto base = chain::model_from_node(parse_toml(c.model, "model.toml"));
  gap::FrequencyExperiment train(c.train_responses[0]);
  const auto result = gap::search(base, {train}, {});
  ASSERT_EQ(result.steps.size(), 1U);
  EXPECT_EQ(result.steps[0].effect->name(), "time_delay");
  // What the delay does to the phase at the top, read off the noisy record itself.
  const auto& r = c.train_responses[0];
  const double phase = -std::arg(r.response.back() / r.response.front());
  EXPECT_NEAR(result.final.terms()[0].unknowns[0].value,
              phase / (r.frequency.back().rad_s().value - r.frequency.front().rad_s().value),
              2e-2 * phase / r.frequency.back().rad_s().value);
}

}  // namespace
