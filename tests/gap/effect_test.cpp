// A new effect is one file: this one stands in the tests alone and is registered from here, and diagnose
// names it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string_view>
#include <utility>

#include "base/documents/json.hpp"
#include "chain/registry.hpp"
#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/report/files.hpp"

namespace {

using namespace bodesmith;

/// An effect stays registered: it proposes while its own test runs, and keeps out of all others of this program.
std::string_view g_proposing;

struct Proposing {
  explicit Proposing(const gap::Effect& effect) {
    gap::effect_registry().add(effect);
    g_proposing = effect.name();
  }
  ~Proposing() { g_proposing = {}; }
};

/// y = u + c u^6: nothing of the catalogue bends a signal at both ends so late.
void propose(const gap::Scene& scene, std::vector<gap::Proposal>& out) {
  if (g_proposing != "sixth_power" || scene.frequency_only) return;
  for (std::size_t at : scene.static_places()) {
    auto block = chain::make_block("polynomial");
    block.set("coefficients", {0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0});
    out.push_back(gap::insert_block(
        scene, at, block, {gap::linear_unknown("coefficients[6]", -10.0, 10.0, 0.1)}, {{0.05}, {-0.05}}));
  }
}

TimeRecord record_with_sixth_power(const char* file, unsigned seed) {
  return of_smoothed_noise(file, seed, 2000, 1e-3, [](int, double x, double e) {
    const double u = std::tanh(3.0 * x);
    const double v = 1.3 * u;
    return std::pair(u, v + 0.05 * std::pow(v, 6) + 0.002 * e);
  });
}

TEST(RegisteredEffect, IsNamedByDiagnose) {
  static const gap::Effect effect({.name = "sixth_power",
                                   .what = "a curve that bends up at both ends",
                                   .experiment = "a slow ramp to the ends of the range",
                                   .propose = propose});
  const Proposing during_this_test(effect);
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.25\nfree = [\"gain\"]\n");
  const auto study = gap::Study::of({record_with_sixth_power("train.csv", 1)},
                                    {record_with_sixth_power("holdout.csv", 2)}, base);
  const auto diagnosis = gap::diagnose(base, study, {});

  ASSERT_EQ(diagnosis.steps.size(), 1U);
  EXPECT_EQ(diagnosis.steps[0].effect, "sixth_power");
  EXPECT_TRUE(diagnosis.steps[0].tied_with.empty());
  EXPECT_EQ(diagnosis.verdict, gap::Verdict::explained);
  const auto json = gap::to_json(diagnosis);
  EXPECT_EQ(json["steps"][0]["effect"], "sixth_power");
  EXPECT_EQ(json["steps"][0]["placed"], "after block 1");
  EXPECT_NEAR(json["steps"][0]["parameters"]["coefficients[6]"]["value"].get<double>(), 0.05, 1e-3);
  EXPECT_NE(gap::report_page(diagnosis, study).find("a curve that bends up at both ends"), std::string::npos);
}

int g_looks = 0;

/// Fitted to their end some names turn out to be another effect's form (a loop whose branches come to coincide): what was next best in the
/// round has its place.
TEST(RegisteredEffect, ThatIsNoneInTheEndLeavesItsPlaceToTheNextBest) {
  static const gap::Effect effect(
      {.name = "twin_of_a_limit",
       .what = "a limit that is one of two each second time that it is looked at",
       .experiment = "none",
       .propose =
           [](const gap::Scene& scene, std::vector<gap::Proposal>& out) {
             if (g_proposing != "twin_of_a_limit") return;
             auto block = chain::make_block("saturation");
             block.set("lower", -100.0);
             out.push_back(gap::insert_block(scene, scene.static_places().back(), block,
                                             {gap::linear_unknown("upper", 0.1, 2.0, 0.1)}, {{0.7}}));
           },
       .is_no_name = [](const gap::Model&, const gap::Term&,
                        const gap::Scene&) { return ++g_looks % 2 == 0; }});
  const Proposing during_this_test(effect);
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.25\nfree = [\"gain\"]\n");
  const auto record = [](const char* file, unsigned seed) {
    return of_smoothed_noise(file, seed, 1000, 1e-3, [](int, double x, double e) {
      return std::pair(3.0 * x, std::min(3.9 * x, 0.8) + 0.002 * e);
    });
  };
  const auto study = gap::Study::of({record("train.csv", 1)}, {record("holdout.csv", 2)}, base);
  gap::SearchOptions options;
  options.max_terms = 1;  // no pairs, which would find it another way
  const auto diagnosis = gap::diagnose(base, study, options);
  EXPECT_GT(g_looks, 1);
  ASSERT_EQ(diagnosis.steps.size(), 1U);
  EXPECT_EQ(diagnosis.steps[0].effect, "saturation");
  EXPECT_EQ(diagnosis.verdict, gap::Verdict::explained);
}

}  // namespace
