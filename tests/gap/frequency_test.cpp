#include <gtest/gtest.h>

#include "base/document.hpp"
#include "chain/model_file.hpp"
#include "gap/cases/response_cases.hpp"
#include "gap/cases/solve.hpp"
#include "gap/search.hpp"

namespace {

using namespace bodesmith;
using hidden::Kind;

hidden::Case make(Kind kind, const std::string& base, const std::string& what, std::uint64_t seed,
                  double ratio = 10.0) {
  return hidden::make_response_case({hidden::World::responses, kind, base, {what}, ratio, seed});
}

TEST(FrequencyResponse, linearEffectsAreNamedOnEveryBase) {
  for (const auto& base : hidden::response_bases()) {
    for (const auto& effect : hidden::response_effects(base)) {
      // Not looked for in responses, and three relaxations that one fractional term imitates.
      if (effect == "sample_hold" || effect == "creep") continue;
      if (base == "sections" && effect == "resonance") continue;  // the fit may end in a side minimum
      const auto o = hidden::solve(make(Kind::effect, base, effect, 2));
      EXPECT_TRUE(o.right) << hidden::line_of(o);
      EXPECT_GT(o.closure, 0.8) << hidden::line_of(o);
    }
  }
}

TEST(FrequencyResponse, aDelaysValueIsFound) {
  const auto c = make(Kind::effect, "gain", "time_delay", 5, 50.0);
  const auto base = chain::model_from_node(parse_toml(c.model, "model.toml"));
  gap::FrequencyExperiment train(c.train_responses[0]);
  gap::FrequencyExperiment holdout(c.holdout_responses[0]);
  const auto result = gap::search(base, {&train}, {&holdout}, {});
  ASSERT_EQ(result.steps.size(), 1U);
  EXPECT_EQ(result.steps[0].effect->name(), "time_delay");
  // What the delay does to the phase at the top, read off the noisy record itself.
  const auto& r = c.train_responses[0];
  const double phase = -std::arg(r.response.back() / r.response.front());
  EXPECT_NEAR(result.final.terms()[0].unknowns[0].value,
              phase / (r.frequency.back().rad_s().value - r.frequency.front().rad_s().value),
              2e-2 * phase / r.frequency.back().rad_s().value);
}

TEST(FrequencyResponse, nothingIsNamedInControls) {
  std::uint64_t seed = 40;
  for (int repeat = 0; repeat < 5; ++repeat) {
    for (const auto& base : hidden::response_bases()) {
      for (const auto& kind : hidden::response_control_kinds()) {
        const auto o = hidden::solve(make(Kind::control, base, kind, ++seed));
        EXPECT_TRUE(o.right) << hidden::line_of(o);
      }
    }
  }
}

}  // namespace
