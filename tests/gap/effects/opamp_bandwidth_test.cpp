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

/// Of a response up to 2 kHz.
std::vector<gap::Proposal> proposed(const char* effect, const gap::Model& model) {
  gap::Scene scene;
  scene.model = &model;
  scene.frequency_only = true;
  scene.band_hz = 300.0;
  scene.top_hz = 2000.0;
  std::vector<gap::Proposal> out;
  gap::effect_registry().get(effect).propose(scene, out);
  return out;
}

TEST(SlowOpamp, IsNamedWithComplexPolesAndWithRealOnes) {
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

TEST(SlowOpamp, StandsWithAMismatchInItsSection) {
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

TEST(SlowOpamp, FollowsThePoleThatAnotherTermMoves) {
  const gap::Model base(lead_section());
  auto proposals = proposed("opamp_bandwidth", base);
  ASSERT_FALSE(proposals.empty());
  gap::Model with_opamp = proposals.front().model;
  with_opamp.set_values(std::vector{2e4});
  proposals = proposed("capacitor_mismatch", with_opamp);
  const auto pole = std::find_if(proposals.begin(), proposals.end(), [](const gap::Proposal& p) {
    return p.model.terms().back().unknowns.front().name == "pole_hz";
  });
  ASSERT_NE(pole, proposals.end());
  gap::Model both = pole->model;
  both.set_values(std::vector{2e4, 660.0});
  for (const double hz : {10.0, 300.0, 3000.0}) {
    const auto response = both.chain().response(Hertz{hz}.rad_s()).value();
    EXPECT_LT(std::abs(response - slow(hz, 2e4, 660.0)), 1e-12 * std::abs(response)) << hz;
  }
  both.remove(1);
  EXPECT_NEAR(std::abs(both.chain().response(Hertz{300.0}.rad_s()).value() - slow(300.0, 2e4)), 0.0, 1e-12);
}

// H P/(P + s D/(2 pi f)) with D of the second order: three poles, of which none, two or one pair is complex.
TEST(SlowOpamp, OfTwoPolesMakesAThird) {
  const gap::Model base(model_of(
      "[[block]]\ntype = \"biquad\"\nlowpass_gain = -2.0\nnatural_frequency_hz = 100.0\ndamping_ratio = 0.4\n"
      "[block.parts]\nC1 = {unit = \"percent\", tolerance = 5.0, \"damping_ratio\" = [0.002, 0.0]}\n"
      "U1 = {gain_bandwidth_hz = 1e9, noise_gain = [3.0, 2.5, 1.5]}\nU2 = {gain_bandwidth_hz = 1e9, noise_gain = [0.0, 2.0, 1.0]}\n"));
  const auto proposals = proposed("opamp_bandwidth", base);
  ASSERT_EQ(proposals.size(), 3U);  // each, and both of one type
  EXPECT_EQ(proposals[0].model.terms().back().part, "U1");
  EXPECT_EQ(proposals[0].model.terms().back().placed, "inside block 1");
  EXPECT_EQ(proposals[2].model.terms().back().part, "U1, U2");
  const auto loop = [](made::Complex s, double f, double d0, double d1, double d2) {
    return 1.0 + s * 100.0 * (1.0 / f - 1e-9) * (d0 + s * (d1 + s * d2)) / (1.0 + s * (0.8 + s));
  };
  for (const double f : {250.0, 900.0, 4e3, 1e6}) {
    for (std::size_t k = 0; k < 3; ++k) {
      gap::Model slow = proposals[k].model;
      slow.set_values(std::vector{f});
      if (!slow.validation_error().empty()) continue;  // it oscillates
      for (const double hz : {3.0, 80.0, 140.0, 3e3}) {
        const made::Complex s(0.0, hz / 100.0);
        made::Complex wanted = -2.0 / (1.0 + s * (0.8 + s));
        if (k != 1) wanted /= loop(s, f, 3.0, 2.5, 1.5);
        if (k != 0) wanted /= loop(s, f, 0.0, 2.0, 1.0);
        EXPECT_LT(std::abs(slow.chain().response(Hertz{hz}.rad_s()).value() / wanted - 1.0), 1e-9)
            << f << " " << hz;
      }
    }
  }
  gap::Model stable = proposals[2].model;
  stable.set_values(std::vector{4e3});
  EXPECT_TRUE(stable.validation_error().empty());
}

// (N + s F/(2 pi f))/(P + s D/(2 pi f)): the section's own numerator moves, and is as it was when the term goes.
TEST(SlowOpamp, ThatSomethingPassesWithoutChangesItsSection) {
  const gap::Model base(model_of(
      "[[block]]\ntype = \"biquad\"\nhighpass_gain = -1.5\nnatural_frequency_hz = 100.0\ndamping_ratio = 0.7\n[block.parts]\n"
      "U1 = {gain_bandwidth_hz = 1e6, noise_gain = [0.0, 4.0, 1.0], feedthrough = [6.0, -3.0, -1.5]}\n"
      "U2 = {gain_bandwidth_hz = 1e6, noise_gain = [3.0, 3.5, 1.0], feedthrough = [-2.0, -1.0, 0.0]}\n"));
  const auto proposals = proposed("opamp_bandwidth", base);
  ASSERT_EQ(proposals.size(), 2U);
  const std::vector<std::vector<double>> d = {{0.0, 4.0, 1.0}, {3.0, 3.5, 1.0}};
  const std::vector<std::vector<double>> f = {{6.0, -3.0, -1.5}, {-2.0, -1.0, 0.0}};
  for (std::size_t k = 0; k < 2; ++k) {
    gap::Model slow = proposals[k].model;
    EXPECT_EQ(slow.terms().back().part, k == 0 ? "U1" : "U2");
    EXPECT_EQ(slow.terms().back().placed, "inside block 1");
    for (const double hz : {2e4, 3e3}) {
      slow.set_values(std::vector{hz});
      ASSERT_TRUE(slow.validation_error().empty()) << slow.validation_error();
      for (const double at : {3.0, 80.0, 140.0, 3e3}) {
        const made::Complex s(0.0, at / 100.0);
        const auto x = s * 100.0 * (1.0 / hz - 1e-6);
        const auto quadratic = [&](const std::vector<double>& q) { return q[0] + s * (q[1] + s * q[2]); };
        const auto wanted =
            (-1.5 * s * s + x * quadratic(f[k])) / (1.0 + s * (1.4 + s) + x * quadratic(d[k]));
        EXPECT_LT(std::abs(slow.chain().response(Hertz{at}.rad_s()).value() / wanted - 1.0), 1e-9)
            << hz << " " << at;
      }
    }
    slow.remove(0);
    EXPECT_EQ(slow.size(), 1U);
    EXPECT_EQ(slow.at(0).get("highpass_gain"), -1.5);
    EXPECT_EQ(slow.at(0).get("bandpass_gain"), 0.0);
  }
}

// A drifted capacitor of a section of two poles, by the name of its part where that is known.
TEST(CapacitorMismatch, OfTwoPolesIsNamed) {
  const std::string section =
      "[[block]]\ntype = \"biquad\"\nname = \"Stage2\"\nlowpass_gain = -2.0\nnatural_frequency_hz = 300.0\ndamping_ratio = 0.4\n";
  const auto shifted = [](double hz, double ratio, bool damps) {  // Tow and Thomas
    const made::Complex s(0.0, hz / 300.0);
    return -2.0 / (1.0 + 0.8 * (damps ? ratio : 1.0) * s + ratio * s * s);
  };
  for (const bool damps : {false, true}) {
    const auto record = made::measured([&](double hz) { return shifted(hz, 1.08, damps); }, 5.0, 2000.0, 120,
                                       [](double) { return 0.002; }, 5);
    const auto result = gap::search(model_of(section), {gap::FrequencyExperiment(record)}, {});
    ASSERT_EQ(result.steps.size(), 1U);
    EXPECT_EQ(result.steps[0].effect->name(), "capacitor_mismatch");
    EXPECT_EQ(result.final.terms().back().part, "Stage2");
    EXPECT_NEAR(result.final.terms().back().unknowns.front().value, 1.08, 0.01);
  }
}

}  // namespace
