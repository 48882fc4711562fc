// Responses that lack several terms at once: modes, lags.
#include <gtest/gtest.h>

#include <algorithm>

#include "gap/made_response.hpp"
#include "gap/runner.hpp"
#include "gap/search.hpp"

namespace {

using namespace bodesmith;

gap::SearchResult found_in(const made::Response& h, double noise, std::uint64_t seed) {
  const auto record = made::measured(
      h, 5.0, 1000.0, 150, [=](double) { return noise; }, seed);
  return gap::search(made::free_gain(1.8), {gap::FrequencyExperiment(record)}, {});
}

std::vector<std::string> names_of(const gap::SearchResult& result) {
  std::vector<std::string> names;
  for (const auto& step : result.steps) names.emplace_back(step.effect->told());
  return names;
}

TEST(SeveralModes, ThreeAreNamedWithTheirFrequencies) {
  const auto h = [](double hz) {
    return 2.0 * made::mode(hz, 95.0, 0.03) * made::mode(hz, 180.0, 0.015) * made::mode(hz, 410.0, 0.05);
  };
  const auto result = found_in(h, 0.01, 3);
  EXPECT_EQ(names_of(result), std::vector<std::string>(3, "resonance"));
  std::vector<double> frequencies;
  for (const auto& term : result.final.terms()) frequencies.push_back(term.unknowns[0].value);
  std::sort(frequencies.begin(), frequencies.end());
  ASSERT_EQ(frequencies.size(), 3U);
  EXPECT_NEAR(frequencies[0], 95.0, 0.3);
  EXPECT_NEAR(frequencies[1], 180.0, 0.3);
  EXPECT_NEAR(frequencies[2], 410.0, 1.0);
  EXPECT_LT(result.train_rms, 0.012);
  EXPECT_TRUE(result.structure.empty());
}

TEST(SeveralModes, OneModeIsNamedOnce) {
  const auto h = [](double hz) { return 2.0 * made::mode(hz, 220.0, 0.02); };
  EXPECT_EQ(names_of(found_in(h, 0.02, 4)), std::vector<std::string>{"resonance"});
}

TEST(SeveralModes, TwoLagsAreTwoPoles) {
  const auto h = [](double hz) { return 2.0 * made::lag(hz, 150.0) * made::lag(hz, 420.0); };
  const auto result = found_in(h, 0.004, 5);
  EXPECT_EQ(names_of(result), std::vector<std::string>(2, "amplifier_pole"));
  ASSERT_EQ(result.final.terms().size(), 2U);
  std::vector<double> corners;
  for (const auto& term : result.final.terms()) corners.push_back(term.unknowns[0].value);
  std::sort(corners.begin(), corners.end());
  EXPECT_NEAR(corners[0], 150.0, 10.0);
  EXPECT_NEAR(corners[1], 420.0, 30.0);
}

TEST(SeveralModes, AModeAndADelayAreBothNamed) {
  const auto h = [](double hz) {
    return 2.0 * made::mode(hz, 220.0, 0.05) * std::polar(1.0, -2.0 * std::numbers::pi * hz * 4e-4);
  };
  auto names = names_of(found_in(h, 0.01, 6));
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"resonance", "time_delay"}));
}

}  // namespace
