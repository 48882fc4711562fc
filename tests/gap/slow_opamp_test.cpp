// A section whose op-amp is so slow that its two poles are a complex pair.
#include <gtest/gtest.h>

#include "gap/search.hpp"
#include "made_response.hpp"

namespace {

using namespace bodesmith;

constexpr double kZeroHz = 100.0;
constexpr double kPoleHz = 600.0;

chain::Chain lead_section() {
  return chain::model_from_node(parse_toml(
      "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"pole_zero\"\ngain = 1.0\nzero_hz = 100.0\npole_hz = 600.0\n",
      "model.toml"));
}

/// H/(1 + (1 + H) s/w_t): 1 + b s + a s^2 has b^2 < 4 a below about 14 kHz.
made::Complex slow(double hz, double gain_bandwidth_hz) {
  const auto h = made::Complex(1.0, hz / kZeroHz) / made::Complex(1.0, hz / kPoleHz);
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

}  // namespace
