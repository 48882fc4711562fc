// A section whose op-amp is so slow that its two poles are a complex pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_response.hpp"
#include "gap/scene.hpp"
#include "gap/search.hpp"

namespace {

using namespace bodesmith;

constexpr double kZeroHz = 100.0;
constexpr double kPoleHz = 600.0;

chain::Chain lead_section() {
  return model_of("[[block]]\ntype = \"pole_zero\"\ngain = 1.0\nzero_hz = 100.0\npole_hz = 600.0\n");
}

/// H/(1 + (1 + H) s/w_t): 1 + b s + a s^2 has b^2 < 4 a below about 14 kHz.
made::Complex slow(double hz, double gain_bandwidth_hz, double pole_hz = kPoleHz) {
  const auto h = made::Complex(1.0, hz / kZeroHz) / made::Complex(1.0, hz / pole_hz);
  return h / (1.0 + (1.0 + h) * made::Complex(0.0, hz / gain_bandwidth_hz));
}

TEST(SlowOpamp, isNamedWithComplexPolesAndWithRealOnes) {
  for (const double gain_bandwidth_hz : {2e3, 6e3, 6e4}) {
    const auto record = made::measured([=](double hz) { return slow(hz, gain_bandwidth_hz); }, 5.0, 2000.0,
                                       120, [](double) { return 0.002; }, 11);
    const auto result = gap::search(lead_section(), {gap::FrequencyExperiment(record)}, {});
    ASSERT_EQ(result.steps.size(), 1U) << gain_bandwidth_hz;
    EXPECT_EQ(result.steps[0].effect->name(), "opamp_bandwidth") << gain_bandwidth_hz;
    const auto& found = result.final.terms().back().unknowns.front();
    EXPECT_NEAR(found.value, gain_bandwidth_hz, 0.02 * gain_bandwidth_hz);
    EXPECT_LT(result.train_rms, 0.0025);
  }
}

TEST(SlowOpamp, standsBesideAMismatchInItsSection) {
  constexpr double kShiftedHz = 660.0;
  constexpr double kGainBandwidthHz = 2e4;
  const auto record = made::measured([](double hz) { return slow(hz, kGainBandwidthHz, kShiftedHz); }, 5.0,
                                     2000.0, 120, [](double) { return 0.002; }, 12);
  const auto result = gap::search(lead_section(), {gap::FrequencyExperiment(record)}, {});
  ASSERT_EQ(result.steps.size(), 2U);
  EXPECT_LT(result.train_rms, 0.0025);
  for (const auto& term : result.final.terms()) {
    // Both kinds of amplifier, inverting or not, fit as well, with another bandwidth.
    if (term.effect->name() == "opamp_bandwidth") continue;
    EXPECT_EQ(term.effect->name(), "capacitor_mismatch");
    EXPECT_NEAR(term.unknowns.front().value, kShiftedHz, 0.03 * kShiftedHz);
  }
}

TEST(SlowOpamp, followsThePoleThatAnotherTermMoves) {
  const gap::Model base(lead_section());
  std::vector<gap::Proposal> proposals;
  gap::Scene scene;
  scene.model = &base;
  scene.frequency_only = true;
  scene.band_hz = 300.0;
  scene.top_hz = 2000.0;
  gap::effect_registry().get("opamp_bandwidth").propose(scene, proposals);
  ASSERT_FALSE(proposals.empty());
  gap::Model with_opamp = proposals.front().model;
  with_opamp.set_values(std::vector{2e4});
  proposals.clear();
  scene.model = &with_opamp;
  gap::effect_registry().get("capacitor_mismatch").propose(scene, proposals);
  const auto pole = std::find_if(proposals.begin(), proposals.end(), [](const gap::Proposal& p) {
    return p.model.terms().back().unknowns.front().name == "pole_hz";
  });
  ASSERT_NE(pole, proposals.end());
  gap::Model both = pole->model;
  both.set_values(std::vector{2e4, 660.0});
  for (const double hz : {10.0, 300.0, 3000.0}) {
    const auto response = both.chain().response(Hertz{hz}.rad_s()).value();
    EXPECT_LT(std::abs(response - slow(hz, 2e4, 660.0)), 3e-4 * std::abs(response)) << hz;
  }
  both.remove(1);
  EXPECT_NEAR(std::abs(both.chain().response(Hertz{300.0}.rad_s()).value() - slow(300.0, 2e4)), 0.0, 1e-4);
}

}  // namespace
