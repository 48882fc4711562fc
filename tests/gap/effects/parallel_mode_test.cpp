// Responses of stages whose modes stand side by side, and of stages with zeros in the right half-plane.
#include <gtest/gtest.h>

#include <algorithm>

#include "chain/registry.hpp"
#include "gap/cases/signals.hpp"
#include "gap/cases/stages.hpp"
#include "gap/cases/time_base.hpp"
#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_response.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search.hpp"

namespace {

using namespace bodesmith;
using made::Complex;

gap::SearchResult found_beside(const made::Response& h, const chain::Chain& base, std::uint64_t seed) {
  const auto record = made::measured(
      h, 5.0, 1000.0, 150, [](double) { return 0.01; }, seed);
  return gap::search(base, {gap::FrequencyExperiment(record)}, {});
}

std::vector<std::string> sorted_names(const gap::SearchResult& result) {
  std::vector<std::string> names;
  for (const auto& step : result.steps) names.emplace_back(step.effect->name());
  std::sort(names.begin(), names.end());
  return names;
}

chain::Chain mode_alone() {
  return model_of(
      "[[block]]\ntype = \"resonator\"\ngain = 1.9\nnatural_frequency_hz = "
      "123.0\ndamping_ratio = 0.022\nfree = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n");
}

TEST(ParallelModesInResponse, OfBothSignsAreNamedWithTheirShares) {
  const auto h = [](double hz) {
    return 2.0 * (1.0 + 0.3 * made::mode(hz, 180.0, 0.02) - 0.1 * made::mode(hz, 310.0, 0.015));
  };
  const auto result = found_beside(h, made::free_gain(1.8), 11);
  ASSERT_EQ(sorted_names(result), (std::vector<std::string>{"parallel_mode", "parallel_mode"}));
  auto terms = result.final.terms();
  std::sort(terms.begin(), terms.end(),
            [](const gap::Term& a, const gap::Term& b) { return a.unknowns[0].value < b.unknowns[0].value; });
  EXPECT_NEAR(terms[0].unknowns[0].value, 180.0, 0.3);
  EXPECT_NEAR(terms[0].unknowns[1].value, 0.02, 0.001);
  EXPECT_NEAR(terms[0].unknowns[2].value, 0.3, 0.01);
  EXPECT_NEAR(terms[1].unknowns[0].value, 310.0, 0.3);
  EXPECT_NEAR(terms[1].unknowns[2].value, -0.1, 0.005);
  EXPECT_LT(result.train_rms, 0.012);
  EXPECT_TRUE(result.structure.empty());
  // One block holds both.
  EXPECT_EQ(result.final.chain().blocks.size(), 2U);
}

TEST(ParallelModesInResponse, StandInParallelWithTheModelsResonator) {
  const auto h = [](double hz) {
    return 2.0 * made::mode(hz, 120.0, 0.02) - 0.3 * made::mode(hz, 330.0, 0.04);
  };
  const auto result = found_beside(h, mode_alone(), 12);
  ASSERT_EQ(sorted_names(result), std::vector<std::string>{"parallel_mode"});
  EXPECT_EQ(result.steps[0].placed, "in parallel with block 1");
  EXPECT_NEAR(result.final.terms()[0].unknowns[0].value, 330.0, 1.0);
  EXPECT_NEAR(result.final.terms()[0].unknowns[2].value, -0.15, 0.005);
  EXPECT_LT(result.train_rms, 0.012);
}

TEST(ParallelModesInResponse, AModeTakenOutLeavesTheOthersWhereTheyAre) {
  const auto h = [](double hz) {
    return 2.0 * (1.0 + 0.3 * made::mode(hz, 180.0, 0.02) + 0.2 * made::mode(hz, 310.0, 0.02));
  };
  auto model = found_beside(h, made::free_gain(1.8), 13).final;
  ASSERT_EQ(model.terms().size(), 2U);
  const double hz = model.terms()[1].unknowns[0].value;
  model.remove(0);
  model.set_values(model.values());
  const auto blocks = model.chain().blocks;
  ASSERT_EQ(blocks.size(), 2U);
  double sum = 0.0;
  for (std::size_t k = 0; k < blocks[1].list("gains").size(); ++k) {
    if (blocks[1].list("gains")[k] == 0.0) continue;
    sum += 1.0;
    EXPECT_EQ(blocks[1].list("natural_frequencies_hz")[k], hz);
  }
  EXPECT_EQ(sum, 1.0);
  model.remove(0);
  EXPECT_EQ(model.chain().blocks.size(), 1U);
}

TEST(ParallelModesInResponse, StandInParallelWithTheResonatorWhateverCameBetween) {
  const auto h = [](double hz) {
    return 2.0 * made::mode(hz, 120.0, 0.02) - 0.3 * made::mode(hz, 330.0, 0.04);
  };
  const gap::Experiments train = {gap::FrequencyExperiment(made::measured(
      h, 5.0, 1000.0, 60, [](double) { return 0.01; }, 5))};
  const auto& effect = gap::effect_registry().get("parallel_mode");
  std::vector<gap::Proposal> proposals;
  effect.propose(gap::make_scene(gap::Model(mode_alone()), train), proposals);
  const auto beside = std::find_if(proposals.begin(), proposals.end(), [](const gap::Proposal& p) {
    return p.model.terms().front().placed == "in parallel with block 1";
  });
  ASSERT_NE(beside, proposals.end());
  gap::Model model = beside->model;
  model.insert(1, chain::make_block("gain"));
  proposals.clear();
  effect.propose(gap::make_scene(model, train), proposals);
  ASSERT_EQ(proposals.size(), 1U);
  const auto blocks = proposals.front().model.chain().blocks;
  EXPECT_EQ(blocks[2].get("resonator_hz"), blocks[0].get("natural_frequency_hz"));
}

/// The model of a gain with these modes {hz, damping, share} in parallel, and a scene up to 1 kHz.
struct WithModes {
  gap::Model model{made::free_gain(2.0)};
  gap::Scene scene;
  explicit WithModes(const std::vector<std::vector<double>>& modes) {
    const gap::Experiments train = {
        gap::FrequencyExperiment(made::measured([](double hz) { return 2.0 + made::mode(hz, 100.0, 0.02); },
                                                5.0, 1000.0, 60, [](double) { return 0.01; }, 5))};
    for (const auto& values : modes) {
      std::vector<gap::Proposal> proposals;
      gap::effect_registry().get("parallel_mode").propose(gap::make_scene(model, train), proposals);
      model = proposals.front().model;
      auto all = model.values();
      std::copy(values.begin(), values.end(), all.end() - 3);
      model.set_values(all);
    }
    scene = gap::make_scene(model, train);
  }
  bool no_name() const {
    return gap::effect_registry().get("parallel_mode").is_no_name(model, model.terms().back(), scene);
  }
};

TEST(ParallelModes, ShareOneBlockAndAddUp) {
  const WithModes two({{180.0, 0.02, 0.3}, {310.0, 0.015, -0.1}});
  const auto chain = two.model.chain();
  ASSERT_EQ(chain.blocks.size(), 2U);
  for (const double hz : {20.0, 170.0, 300.0, 900.0}) {
    const Complex expected =
        2.0 * (1.0 + 0.3 * made::mode(hz, 180.0, 0.02) - 0.1 * made::mode(hz, 310.0, 0.015));
    EXPECT_LT(std::abs(*chain.response(Hertz{hz}.rad_s()) - expected), 1e-9) << hz;
  }
}

TEST(ParallelModes, AreNoNameBeyondTheBand) {
  EXPECT_FALSE(WithModes({{180.0, 0.02, 0.3}}).no_name());
  EXPECT_TRUE(WithModes({{1100.0, 0.02, 0.3}}).no_name());
  EXPECT_TRUE(WithModes({{4.0, 0.02, 0.3}}).no_name());
}

/// Of a stage whose sensor sees its second mode the other way round.
TimeRecord record_beside(hidden::Drive drive, unsigned seed) {
  constexpr std::size_t kRows = 1200;
  constexpr double kStepS = 1e-4;
  hidden::Random random(seed);
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = kStepS;
  r.u = hidden::make_drive(drive, kRows, kStepS, 1000.0, random);
  const auto first = hidden::play_chain({hidden::mode({1.0, 450.0, 0.04})}, r.u, kStepS);
  const auto second = hidden::play_chain({hidden::mode({1.0, 820.0, 0.03})}, r.u, kStepS);
  const auto noise = hidden::make_noise(hidden::Colour::white, kRows, random);
  for (std::size_t i = 0; i < kRows; ++i)
    r.y.push_back(2.0 * (r.u[i] + 0.3 * first[i] - 0.15 * second[i]) + 0.004 * noise[i]);
  return r;
}

TEST(ParallelModesInTime, OfBothSignsAreNamed) {
  const auto study = gap::Study::of({record_beside(hidden::Drive::noise, 1)},
                                    {record_beside(hidden::Drive::multisine, 2)}, made::free_gain(1.8));
  const auto found = gap::diagnose(made::free_gain(1.8), study, {});
  ASSERT_EQ(found.steps.size(), 2U);
  for (const auto& step : found.steps) EXPECT_EQ(step.effect, "resonance");
  EXPECT_LT(found.final.holdout_rms, 0.1 * found.refitted.holdout_rms);
}

TEST(ZeroInTheRightHalfPlane, IsNamedAsAnAllPassAndWithAPole) {
  const auto all_pass = [](double hz) { return 2.0 * Complex(1.0, -hz / 300.0) / Complex(1.0, hz / 300.0); };
  const auto first = found_beside(all_pass, made::free_gain(1.8), 14);
  ASSERT_EQ(sorted_names(first), std::vector<std::string>{"right_half_plane_zero"});
  EXPECT_EQ(first.final.terms()[0].unknowns.size(), 1U);
  EXPECT_NEAR(first.final.terms()[0].unknowns[0].value, 300.0, 3.0);
  const auto with_pole = [](double hz) { return 2.0 * Complex(1.0, -hz / 200.0) / Complex(1.0, hz / 700.0); };
  const auto second = found_beside(with_pole, made::free_gain(1.8), 15);
  ASSERT_EQ(sorted_names(second), std::vector<std::string>{"right_half_plane_zero"});
  ASSERT_EQ(second.final.terms()[0].unknowns.size(), 2U);
  EXPECT_NEAR(second.final.terms()[0].unknowns[0].value, 200.0, 4.0);
  EXPECT_NEAR(second.final.terms()[0].unknowns[1].value, 700.0, 20.0);
}

TEST(ZeroInTheRightHalfPlane, TakesNoNameFromADelayOrTwoLags) {
  const auto late = [](double hz) { return 2.0 * std::polar(1.0, -2.0 * std::numbers::pi * hz * 1e-4); };
  const auto delay = found_beside(late, made::free_gain(1.8), 16);
  ASSERT_EQ(sorted_names(delay), std::vector<std::string>{"time_delay"});
  const auto& tied = delay.steps[0].tied_with;
  EXPECT_EQ(std::count(tied.begin(), tied.end(), "right_half_plane_zero"), 0);
  const auto lags = [](double hz) { return 2.0 * made::lag(hz, 500.0) * made::lag(hz, 1500.0); };
  EXPECT_EQ(sorted_names(found_beside(lags, made::free_gain(1.8), 17)),
            (std::vector<std::string>{"amplifier_pole", "amplifier_pole"}));
}

}  // namespace
