#include "../../examples/hysteresis_tables/virtual_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace bench {
namespace {

TEST(VirtualStage, HasLoopsThatShrinkWithRateAndMirrorsNoModel) {
  VirtualStageSettings settings = VirtualStageSettings::piezoceramic();
  settings.noise_rms = 0.0;
  double before = 1e9;
  for (const double f : {1.0, 10.0, 100.0}) {
    VirtualStage stage(settings);
    stage.reset(0.0);
    double low = 1e9, high = -1e9;
    for (int i = 1; i <= 6 * 500; ++i) {
      const double y =
          stage.step(60.0 - 60.0 * std::cos(2 * std::numbers::pi * i / 500.0), 1.0 / (500.0 * f));
      if (i > 5 * 500) {
        low = std::min(low, y);
        high = std::max(high, y);
      }
    }
    EXPECT_LT(high - low, before) << f;
    before = high - low;
  }
  EXPECT_NEAR(before, 30.0, 8.0);
}

TEST(VirtualStage, LinearPartsHaveTheirFrequencyResponse) {
  VirtualStageSettings settings;
  settings.alpha = 1e-9;  // no memory
  settings.slope = 1.0;
  settings.asymmetry = 0.0;
  settings.rate_beta = 0.3;
  settings.rate_from_hz = 10.0;
  settings.rate_to_hz = 1000.0;
  settings.amplifier_hz = 500.0;
  settings.resonance_hz = 800.0;
  settings.damping_ratio = 0.2;
  VirtualStage stage(settings);
  const double f = 100.0, w = 2 * std::numbers::pi * f;
  const int n = 1000;
  stage.reset(0.0);
  std::complex<double> sum = 0.0;
  for (int i = 1; i <= 80 * n; ++i) {
    const double y = stage.step(std::sin(w * i / (n * f)), 1.0 / (n * f));
    if (i > 70 * n) sum += y * std::polar(1.0, -w * i / (n * f));
  }
  sum *= std::complex<double>(0.0, 2.0 / (10.0 * n));
  const std::complex<double> s(0.0, w), lag = 1.0 / (1.0 + s / (2 * std::numbers::pi * 500.0));
  const double w0 = 2 * std::numbers::pi * 800.0;
  const std::complex<double> mass = w0 * w0 / (s * s + 0.4 * w0 * s + w0 * w0);
  const std::complex<double> rate =
      std::pow((1.0 + s / (2 * std::numbers::pi * 1000.0)) / (1.0 + s / (2 * std::numbers::pi * 10.0)), 0.3);
  EXPECT_LT(std::abs(sum / (lag * mass * rate) - 1.0), 0.01);
}

TEST(VirtualStage, SameSeedSameNoise) {
  VirtualStage a(VirtualStageSettings::pusher()), b(VirtualStageSettings::pusher());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.step(0.5 * i, 1e-3), b.step(0.5 * i, 1e-3));
}

}  // namespace
}  // namespace bench
