#include "gap/search.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/document.hpp"
#include "chain/model_file.hpp"
#include "gap/batch.hpp"
#include "gap/diagnosis.hpp"
#include "simulate/simulate.hpp"

namespace {

using namespace bodesmith;
using hidden::solve;

TEST(Search, namesAnEffectOfEachKindAtTenTimesTheNoise) {
  const std::pair<const char*, const char*> places[] = {
      {"gain", "saturation"},          {"gain", "hysteresis"},
      {"gain", "mains_hum"},           {"resonator", "cubic_stiffness"},
      {"resonator", "time_delay"},     {"gain", "drift"},
      {"sections", "dead_zone"},       {"sections", "capacitor_mismatch"},
      {"sections", "opamp_bandwidth"}, {"fixed_gain", "gain_error"}};
  int right = 0;
  int count = 0;
  for (const auto& [base, effect] : places) {
    const auto c = hidden::make_effect_case(base, effect, 10.0, 400 + static_cast<std::uint64_t>(count++));
    const auto o = solve(c);
    right += o.right ? 1 : 0;
    EXPECT_TRUE(o.right) << hidden::line_of(o);
    EXPECT_GT(o.closure, 0.8) << hidden::line_of(o);
  }
  EXPECT_EQ(right, count);
}

TEST(Search, namesNothingInControlsOfEveryKind) {
  std::uint64_t seed = 900;
  for (const char* base : {"gain", "resonator", "sections"}) {
    for (const auto& kind : hidden::control_kinds()) {
      const auto c = hidden::make_control_case(base, kind, ++seed);
      const auto o = solve(c);
      EXPECT_TRUE(o.named.empty()) << hidden::line_of(o);
      EXPECT_EQ(o.verdict, gap::Verdict::nothing_missing) << hidden::line_of(o);
    }
  }
}

TEST(Search, doesNotCallOutsideCasesExplained) {
  std::uint64_t seed = 1300;
  for (const auto& kind : hidden::outside_kinds()) {
    const auto c = hidden::make_outside_case("gain", kind, ++seed);
    const auto o = solve(c);
    EXPECT_TRUE(o.right) << hidden::line_of(o);
  }
}

TEST(Search, findsTwoEffectsWhicheverIsHiddenFirst) {
  for (const auto& [first, second] :
       {std::pair{"saturation", "mains_hum"}, std::pair{"mains_hum", "saturation"}}) {
    const auto c = hidden::make_pair_case("gain", first, second, 10.0, 77);
    const auto o = solve(c);
    EXPECT_TRUE(o.right) << hidden::line_of(o);
  }
}

TEST(Search, isTheSameOnOneThreadAndOnTwo) {
  const auto c = hidden::make_effect_case("gain", "backlash", 10.0, 5);
  const auto one = solve(c, 1);
  const auto two = solve(c, 2);
  EXPECT_EQ(one.named, two.named);
  EXPECT_EQ(one.closure, two.closure);
}

TEST(Search, keepsWhatItHasWhenStopped) {
  const auto c = hidden::make_effect_case("gain", "saturation", 10.0, 6);
  const auto chain = chain::model_from_node(parse_toml(c.model, "model.toml"));
  gap::TimeExperiment train(c.train);
  gap::TimeExperiment holdout(c.holdout);
  gap::SearchOptions options;
  options.stop = [] { return true; };
  const auto result = gap::search(chain, {&train}, {&holdout}, options);
  EXPECT_TRUE(result.stopped);
  EXPECT_TRUE(result.steps.empty());
  EXPECT_FALSE(gap::residuals_of(result.final, {&train}).empty());
}

// What diagnosis.json claims is what simulate finds with the model that is written.
TEST(Diagnosis, claimsEqualRecomputation) {
  const auto c = hidden::make_effect_case("resonator", "saturation", 10.0, 7);
  const auto base = chain::model_from_node(parse_toml(c.model, "model.toml"));
  const auto study = gap::Study::of({c.train}, {c.holdout}, base);
  const auto d = gap::diagnose(base, study, {});
  ASSERT_EQ(d.steps.size(), 1U);
  const auto text = chain::model_text(d.search.final.chain());
  const auto written = chain::model_from_node(parse_toml(text, "model.toml"));
  const auto y = simulate::simulate(written, c.holdout).y;
  double from_s = -1.0;
  for (const auto& s : d.scored_from) {
    if (s.held_out) from_s = s.from_s;
  }
  double sum = 0.0;
  double whole = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double e = y[i] - c.holdout.y[i];
    whole += e * e;
    if (c.holdout.time_s(i) < from_s - 1e-12) continue;
    sum += e * e;
    ++count;
  }
  EXPECT_NEAR(d.final.holdout_rms, std::sqrt(sum / count), 1e-9 * d.final.holdout_rms);
  EXPECT_NEAR(d.final.holdout_whole_rms, std::sqrt(whole / static_cast<double>(y.size())),
              1e-9 * d.final.holdout_whole_rms);
  EXPECT_NEAR(d.steps[0].after.holdout_rms, d.final.holdout_rms, 1e-12);
  const auto json = gap::to_json(d);
  EXPECT_EQ(json["steps"][0]["effect"], "saturation");
  EXPECT_EQ(json["verdict"], "explained");
  EXPECT_FALSE(json["where"].empty());
  const auto page = gap::report_page(d, study);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

}  // namespace
