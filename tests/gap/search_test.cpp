#include "gap/search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "chain/model_file.hpp"
#include "gap/cases/expect.hpp"
#include "gap/cases/time_cases.hpp"
#include "gap/diagnosis.hpp"
#include "gap/report/files.hpp"
#include "gap/runner.hpp"
#include "simulate/simulate.hpp"
#include "texts.hpp"

namespace {

using namespace bodesmith;
using hidden::Hidden;
using hidden::Kind;
using hidden::solve;
using hidden::World;

constexpr std::size_t kRows = 3000;

/// Of sections, whose every part is a hypothesis, half as many.
std::size_t rows_of(const Hidden& h) {
  return std::string_view(h.base) == "sections" ? kRows / 2 : kRows;
}

hidden::Case make(Kind kind, const std::string& base, std::vector<std::string> what, std::uint64_t seed) {
  return hidden::make_case({World::formulas, kind, base, std::move(what), 10.0, seed, kRows});
}

class HiddenEffect : public testing::TestWithParam<Hidden> {};
TEST_P(HiddenEffect, IsNamedAtTenTimesTheNoise) {
  const auto outcome = hidden::expect_right(World::formulas, Kind::effect, GetParam(), rows_of(GetParam()));
  EXPECT_GT(outcome.closure, 0.8) << hidden::line_of(outcome);
}
INSTANTIATE_TEST_SUITE_P(Search, HiddenEffect,
                         testing::Values(Hidden{"gain", "saturation", 400}, Hidden{"gain", "mains_hum", 402},
                                         Hidden{"resonator", "cubic_stiffness", 403},
                                         Hidden{"gain", "drift", 405},
                                         Hidden{"sections", "opamp_bandwidth", 410},
                                         Hidden{"fixed_gain", "gain_error", 409}),
                         hidden::HiddenName());

std::vector<Hidden> controls() {
  std::vector<Hidden> all;
  std::uint64_t seed = 900;
  for (const char* base : {"gain", "resonator"}) {
    for (const auto& kind : hidden::control_kinds()) all.push_back({base, kind.c_str(), ++seed});
  }
  return all;
}

class Control : public testing::TestWithParam<Hidden> {};
TEST_P(Control, IsLeftAlone) {
  const auto outcome = hidden::expect_right(World::formulas, Kind::control, GetParam(), rows_of(GetParam()));
  EXPECT_TRUE(outcome.named.empty()) << hidden::line_of(outcome);
  EXPECT_EQ(outcome.verdict, "nothing_missing") << hidden::line_of(outcome);
}
INSTANTIATE_TEST_SUITE_P(Search, Control, testing::ValuesIn(controls()), hidden::HiddenName());

std::vector<Hidden> outsiders() {
  std::vector<Hidden> all;
  std::uint64_t seed = 1300;
  for (const auto& kind : hidden::outside_kinds()) all.push_back({"gain", kind.c_str(), ++seed});
  return all;
}

/// Shorter than the others' records.
constexpr std::size_t kOutsiderRows = 1200;

class Outsider : public testing::TestWithParam<Hidden> {};
TEST_P(Outsider, IsNotCalledExplained) {
  hidden::expect_right(World::formulas, Kind::outside, GetParam(), kOutsiderRows,
                       {.max_terms = hidden::kOutsiderTerms});
}
INSTANTIATE_TEST_SUITE_P(Search, Outsider, testing::ValuesIn(outsiders()), hidden::HiddenName());

class TwoEffects : public testing::TestWithParam<std::vector<std::string>> {};
TEST_P(TwoEffects, AreBothNamedWhicheverIsHiddenFirst) {
  const auto outcome = solve(make(Kind::pair, "gain", GetParam(), 75));
  EXPECT_TRUE(outcome.right) << hidden::line_of(outcome);
}
INSTANTIATE_TEST_SUITE_P(Search, TwoEffects,
                         testing::Values(std::vector<std::string>{"saturation", "mains_hum"},
                                         std::vector<std::string>{"mains_hum", "saturation"}),
                         [](const auto& test) { return test.param[0] + "_first"; });

TEST(Search, IsTheSameOnOneThreadAndOnTwo) {
  const auto c = make(Kind::effect, "gain", {"dead_zone"}, 5);
  const auto one = solve(c, {.threads = 1});
  const auto two = solve(c, {.threads = 2});
  EXPECT_EQ(one.named, two.named);
  EXPECT_EQ(one.closure, two.closure);
}

TEST(Search, KeepsWhatItHasWhenStopped) {
  const auto c = make(Kind::effect, "gain", {"saturation"}, 6);
  const auto chain = chain::model_from_node(parse_toml(c.model, "model.toml"));
  gap::TimeExperiment train(c.train[0]);
  gap::SearchOptions options;
  options.stop = [] { return true; };
  const auto result = gap::search(chain, {train}, options);
  EXPECT_TRUE(result.stopped);
  EXPECT_TRUE(result.steps.empty());
  EXPECT_FALSE(gap::residuals_of(result.final, {train}).empty());
}

// What diagnosis.json claims is what simulate finds with the model that is written.
TEST(Diagnosis, ClaimsEqualRecomputation) {
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
  EXPECT_FALSE(has_match(page, "\\bnan\\b"));  // "resonance" holds the letters
}

}  // namespace
