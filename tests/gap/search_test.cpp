#include "gap/search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "base/document.hpp"
#include "chain/model_file.hpp"
#include "gap/cases/solve.hpp"
#include "gap/cases/time_cases.hpp"
#include "gap/diagnosis.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace bodesmith;
using hidden::Kind;
using hidden::solve;
using hidden::World;

hidden::Case make(Kind kind, const std::string& base, std::vector<std::string> what, std::uint64_t seed,
                  double ratio = 10.0) {
  return hidden::make_time_case({World::formulas, kind, base, std::move(what), ratio, seed, 3000});
}

TEST(Search, namesAnEffectOfEachKindAtTenTimesTheNoise) {
  struct Place {
    const char* base;
    const char* effect;
    std::uint64_t seed;
  };
  const Place places[] = {{"gain", "saturation", 400},          {"gain", "hysteresis", 402},
                          {"gain", "mains_hum", 402},           {"resonator", "cubic_stiffness", 403},
                          {"resonator", "time_delay", 404},     {"gain", "drift", 405},
                          {"sections", "dead_zone", 406},       {"sections", "capacitor_mismatch", 407},
                          {"sections", "opamp_bandwidth", 410}, {"fixed_gain", "gain_error", 409}};
  for (const auto& [base, effect, seed] : places) {
    const auto o = solve(make(Kind::effect, base, {effect}, seed));
    EXPECT_TRUE(o.right) << hidden::line_of(o);
    EXPECT_GT(o.closure, 0.8) << hidden::line_of(o);
  }
}

TEST(Search, namesNothingInControlsOfEveryKind) {
  std::uint64_t seed = 900;
  for (const char* base : {"gain", "resonator", "sections"}) {
    for (const auto& kind : hidden::control_kinds()) {
      const auto c = make(Kind::control, base, {kind}, ++seed);
      const auto o = solve(c);
      EXPECT_TRUE(o.named.empty()) << hidden::line_of(o);
      EXPECT_EQ(o.verdict, "nothing_missing") << hidden::line_of(o);
    }
  }
}

TEST(Search, doesNotCallOutsideCasesExplained) {
  std::uint64_t seed = 1300;
  for (const auto& kind : hidden::outside_kinds()) {
    if (kind == "level_jump") continue;  // passes for red noise
    const auto c = make(Kind::outside, "gain", {kind}, ++seed);
    const auto o = solve(c);
    EXPECT_TRUE(o.right) << hidden::line_of(o);
  }
}

TEST(Search, findsTwoEffectsWhicheverIsHiddenFirst) {
  for (const auto& [first, second] :
       {std::pair{"saturation", "mains_hum"}, std::pair{"mains_hum", "saturation"}}) {
    const auto c = make(Kind::pair, "gain", {first, second}, 75);
    const auto o = solve(c);
    EXPECT_TRUE(o.right) << hidden::line_of(o);
  }
}

TEST(Search, isTheSameOnOneThreadAndOnTwo) {
  const auto c = make(Kind::effect, "gain", {"dead_zone"}, 5);
  const auto one = solve(c, {.threads = 1});
  const auto two = solve(c, {.threads = 2});
  EXPECT_EQ(one.named, two.named);
  EXPECT_EQ(one.closure, two.closure);
}

TEST(Search, keepsWhatItHasWhenStopped) {
  const auto c = make(Kind::effect, "gain", {"saturation"}, 6);
  const auto chain = chain::model_from_node(parse_toml(c.model, "model.toml"));
  gap::TimeExperiment train(c.train[0]);
  gap::TimeExperiment holdout(c.holdout[0]);
  gap::SearchOptions options;
  options.stop = [] { return true; };
  const auto result = gap::search(chain, {&train}, {&holdout}, options);
  EXPECT_TRUE(result.stopped);
  EXPECT_TRUE(result.steps.empty());
  EXPECT_FALSE(gap::residuals_of(result.final, {&train}).empty());
}

// What diagnosis.json claims is what simulate finds with the model that is written.
TEST(Diagnosis, claimsEqualRecomputation) {
  const auto c = make(Kind::effect, "resonator", {"saturation"}, 7);
  const auto base = chain::model_from_node(parse_toml(c.model, "model.toml"));
  const auto study = gap::Study::of(c.train, c.holdout, base);
  const auto d = gap::diagnose(base, study, {});
  ASSERT_EQ(d.steps.size(), 1U);
  const auto text = chain::model_text(d.search.final.chain());
  const auto written = chain::model_from_node(parse_toml(text, "model.toml"));
  double sum = 0.0, whole = 0.0;
  std::size_t count = 0, all = 0;
  for (const auto& record : c.holdout) {
    const auto y = simulate::simulate(written, record).y;
    double from_s = -1.0;
    for (const auto& part : d.scored_from) {
      if (part.held_out && part.file == record.file) from_s = part.from_s;
    }
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double e = y[i] - record.y[i];
      whole += e * e;
      ++all;
      if (record.time_s(i) < from_s - 1e-12) continue;
      sum += e * e;
      ++count;
    }
  }
  EXPECT_NEAR(d.final.holdout_rms, std::sqrt(sum / static_cast<double>(count)), 1e-9 * d.final.holdout_rms);
  EXPECT_NEAR(d.final.holdout_whole_rms, std::sqrt(whole / static_cast<double>(all)),
              1e-9 * d.final.holdout_whole_rms);
  EXPECT_NEAR(d.steps[0].after.holdout_rms, d.final.holdout_rms, 1e-12);
  const auto json = gap::to_json(d);
  EXPECT_EQ(json["steps"][0]["effect"], "saturation");
  EXPECT_EQ(json["verdict"], "explained");
  EXPECT_FALSE(json["where"].empty());
  const auto page = gap::report_page(d, study);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_FALSE(std::regex_search(page, std::regex("\\bnan\\b")));  // "resonance" holds the letters
}

}  // namespace
