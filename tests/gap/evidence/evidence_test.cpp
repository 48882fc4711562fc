// What a name must show, and what an unknown costs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "gap/effect.hpp"
#include "gap/evidence/posterior.hpp"
#include "gap/evidence/score.hpp"
#include "gap/made_model.hpp"
#include "gap/model/model_fit.hpp"
#include "gap/scene.hpp"

namespace evidence {
namespace {

using namespace bodesmith;

constexpr int kSamples = 900;

/// A gain of 1 with noise of size .1 that forgets itself in so many samples.
gap::Experiments record_with_noise(double correlation_samples, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double rho = std::exp(-1.0 / correlation_samples);
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = 1e-3;
  double noise = normal(random);
  for (int i = 0; i < kSamples; ++i) {
    noise = rho * noise + std::sqrt(1.0 - rho * rho) * normal(random);
    r.u.push_back(normal(random));
    r.y.push_back(r.u.back() + 0.1 * noise);
  }
  return {gap::TimeExperiment(r)};
}

const std::string kGain = "[[block]]\ntype = \"gain\"\ngain = 1.0\n";

// The posterior's width over the prior's, which is a quarter for a free gain. T = 3.
TEST(Evidence, AnUnknownCostsTheLogarithmOfItsPriorOverItsPosterior) {
  const auto train = record_with_noise(0.05, 4);
  const auto fitted = gap::fit(gap::Model(model_of(kGain + "free = [\"gain\"]\n")), train).model;
  const double fixed = gap::log_evidence(gap::Model(model_of(kGain)), train);
  const double free = gap::log_evidence(fitted, train);
  const double deviation = 0.1 / std::sqrt(kSamples);
  // What the fit gains by chance is about a quarter of the logarithm, or less.
  EXPECT_NEAR(fixed - free, 0.5 * std::log(1.0 + std::pow(0.25 / deviation, 2) / 3.0), 1.5);
}

TEST(Evidence, AnUnknownThatChangesNothingCostsNothing) {
  const auto train = record_with_noise(0.05, 5);
  const std::string far = "[[block]]\ntype = \"saturation\"\nlower = -90.0\nupper = 90.0\n";
  const gap::Model fixed(model_of(kGain + far));
  const gap::Model free(model_of(kGain + far + "free = [\"upper\"]\n"));
  EXPECT_NEAR(gap::log_evidence(free, train), gap::log_evidence(fixed, train), 1e-9);
}

/// By how much a straight line raises the evidence.
double gain_of_drift(const gap::Experiments& train) {
  const gap::Model base(model_of(kGain));
  std::vector<gap::Proposal> proposals;
  gap::effect_registry().get("drift").propose(gap::make_scene(base, train), proposals);
  return gap::log_evidence(gap::fit(proposals.front().model, train).model, train) -
         gap::log_evidence(base, train);
}

// What a line takes of slow noise is chance; a line of ten times the noise is none.
TEST(Evidence, SlowNoiseIsNoDrift) {
  for (unsigned seed = 1; seed <= 12; ++seed) EXPECT_LT(gain_of_drift(record_with_noise(300.0, seed)), 3.0);
  auto line = std::get<gap::TimeExperiment>(record_with_noise(0.05, 3).front()).record();
  for (std::size_t i = 0; i < line.size(); ++i) line.y[i] += static_cast<double>(i) / kSamples;
  EXPECT_GT(gain_of_drift({gap::TimeExperiment(line)}), 15.0);
}

gap::SearchResult slewing_alone() {
  gap::SearchResult result;
  gap::Step step;
  step.effect = &gap::effect_registry().get("slew_limit");
  step.log_evidence_without = -std::numeric_limits<double>::infinity();
  result.steps = {step};
  return result;
}

// Without the limit the spring's model runs away: what cannot be run has no evidence, and the name is sure.
TEST(Evidence, AModelThatCannotBeRunIsNoRival) {
  const auto posterior = gap::posterior_of(slewing_alone(), false, 0.0);
  EXPECT_EQ(posterior.among_names.front(), 1.0);
  ASSERT_EQ(posterior.alternatives.size(), 1U);
  EXPECT_EQ(posterior.alternatives.front().probability, 1.0);
}

// What a name leaves of the gap, and that more is missing, make it less sure; a sign of that the more the plainer it is.
TEST(Evidence, ANameIsDoubtedWhereMoreIsLeft) {
  auto result = slewing_alone();
  const auto probability = [&](bool more_is_left, double left) {
    const auto posterior = gap::posterior_of(result, more_is_left, left);
    return (1.0 - posterior.outside) * posterior.among_names.front();
  };
  EXPECT_GT(probability(false, 0.01), 0.95);
  EXPECT_LT(probability(false, 0.0), 1.0);
  EXPECT_EQ(probability(true, std::numeric_limits<double>::infinity()), 0.0);
  for (const double left : {0.1, 0.3, 1.0}) {
    result.structure.clear();
    double before = probability(false, left);
    for (const double plainest : {0.0, 1.1, 3.0, 30.0}) {  // held-out records alone, then signs
      if (plainest > 0.0)
        result.structure = {{gap::SignKind::spectral_line, 1.05}, {gap::SignKind::jumps, plainest}};
      const double more = probability(true, left);
      EXPECT_LT(more, before) << plainest;
      EXPECT_LT(probability(true, 2.0 * left), more) << plainest;
      before = more;
    }
  }
}

}  // namespace
}  // namespace evidence
