// What a fit looks like on data that did not choose its values, and that the search keeps to such data.
#include "gap/search/folds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/document.hpp"
#include "chain/model_file.hpp"
#include "gap/cases/case_list.hpp"
#include "gap/diagnosis.hpp"
#include "gap/model_fit.hpp"
#include "gap/runner.hpp"
#include "signal/statistics.hpp"

namespace {

using namespace bodesmith;

chain::Chain line_of(double gain) {
  return chain::model_from_node(parse_toml(
      "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = " + std::to_string(gain) +
          "\noffset = 0.1\nfree = [\"gain\", \"offset\"]\n",
      "model.toml"));
}

TimeRecord line_with_noise(unsigned seed, double gain) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = 1e-3;
  for (int i = 0; i < 100; ++i) {
    r.u.push_back(normal(random));
    r.y.push_back(gain * r.u.back() + 0.3 + 0.5 * normal(random));
  }
  return r;
}

TEST(Folds, areWhatRefitsWithoutEachRecordLeave) {
  const gap::Experiments train = {gap::TimeExperiment(line_with_noise(1, 1.0)),
                                  gap::TimeExperiment(line_with_noise(2, 1.4)),
                                  gap::TimeExperiment(line_with_noise(3, 0.8))};
  // Given values this far off count for next to nothing beside 300 samples.
  const auto fitted = gap::fit(gap::Model(line_of(1.0)), train).model;
  const auto folds = gap::folded_residuals(fitted, train, gap::Folds::records);
  ASSERT_EQ(folds.size(), 300U);
  for (std::size_t k = 0; k < 3; ++k) {
    gap::Experiments rest = train;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    const auto alone = gap::residuals_of(gap::fit(gap::Model(line_of(1.0)), rest).model, {train[k]});
    const std::vector<double> fold(folds.begin() + static_cast<std::ptrdiff_t>(100 * k),
                                   folds.begin() + static_cast<std::ptrdiff_t>(100 * k + 100));
    EXPECT_NEAR(rms(fold), rms(alone), 0.01 * rms(alone));
  }
  EXPECT_GT(rms(folds), rms(gap::residuals_of(fitted, train)));
}

TEST(Folds, theHeldOutRecordDecidesNothing) {
  auto c = hidden::make_case(
      {hidden::World::formulas, hidden::Kind::effect, "gain", {"saturation"}, 10.0, 31, 1200});
  const auto base = chain::model_from_node(parse_toml(c.model, "model.toml"));
  const auto as_it_is = gap::diagnose(base, gap::Study::of(c.train, c.holdout, base), {});
  for (auto& record : c.holdout) {
    for (double& y : record.y) y = -0.3 * y + 0.2;
  }
  const auto spoilt = gap::diagnose(base, gap::Study::of(c.train, c.holdout, base), {});
  ASSERT_EQ(as_it_is.steps.size(), 1U);
  ASSERT_EQ(spoilt.steps.size(), 1U);
  EXPECT_EQ(spoilt.steps[0].effect, as_it_is.steps[0].effect);
  EXPECT_EQ(spoilt.steps[0].parameters[0].value, as_it_is.steps[0].parameters[0].value);
  // Only the verdict says that it disagrees.
  EXPECT_FALSE(as_it_is.holdout_disagrees);
  EXPECT_TRUE(spoilt.holdout_disagrees);
  EXPECT_NE(spoilt.advice.find("disagree"), std::string::npos);
}

}  // namespace
