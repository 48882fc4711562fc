#include "signal/periodogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace bodesmith {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Spectrum, LinesOfWholePeriodsAreExact) {
  // 0.3 + 2 cos(2 pi 5 t + 40 deg) + 0.5 cos(2 pi 15 t - 100 deg), from t = 0.123 s on.
  const double start = 0.123;
  std::vector<double> x;
  for (int i = 0; i < 200; ++i) {
    const double t = start + 1e-3 * i;
    x.push_back(0.3 + 2.0 * std::cos(2.0 * kPi * 5.0 * t + 40.0 * kPi / 180.0) +
                0.5 * std::cos(2.0 * kPi * 15.0 * t - 100.0 * kPi / 180.0));
  }
  const Spectrum s = spectrum_of(x, start, 1e-3, true);
  ASSERT_EQ(s.frequency.size(), 101u);
  EXPECT_DOUBLE_EQ(s.frequency[3].value, 15.0);
  EXPECT_NEAR(s.amplitude[0], 0.3, 1e-14);
  EXPECT_NEAR(s.amplitude[1], 2.0, 1e-13);
  EXPECT_NEAR(s.phase_deg[1], 40.0, 1e-10);
  EXPECT_NEAR(s.amplitude[3], 0.5, 1e-13);
  EXPECT_NEAR(s.phase_deg[3], -100.0, 1e-10);
  EXPECT_LT(s.amplitude[2], 1e-13);
  EXPECT_EQ(s.phase_deg[2], 0.0);
  EXPECT_NEAR(*distortion_percent(s, 1), 25.0, 1e-10);
  EXPECT_FALSE(distortion_percent(s, 0));
}

TEST(Spectrum, WindowKeepsTheAmplitudeOfALine) {
  std::vector<double> x;
  for (int i = 0; i < 1000; ++i) x.push_back(1.5 * std::cos(2.0 * kPi * 50.0 * i * 1e-3 + 0.3));
  const Spectrum s = spectrum_of(x, 0.0, 1e-3, false);
  EXPECT_NEAR(s.amplitude[50], 1.5, 1e-12);
  EXPECT_NEAR(s.phase_deg[50], 0.3 * 180.0 / kPi, 1e-9);
  EXPECT_NEAR(s.amplitude[51], 0.75, 1e-12);
  EXPECT_LT(s.amplitude[53], 1e-12);
}

/// Of the same lines, at phases drawn anew with every seed.
TEST(PhaseSurrogate, HasTheSpectrumAndNothingElse) {
  std::vector<double> v;
  for (int i = 0; i < 64; ++i) v.push_back(2.0 + std::cos(0.7 * i) + 0.3 * std::sin(0.11 * i * i));
  const std::vector<double> first = phase_surrogate(v, 1), second = phase_surrogate(v, 2);
  EXPECT_EQ(first, phase_surrogate(v, 1));
  const auto lines = [](std::vector<double> x) {
    double sum = 0.0;
    for (const double one : x) sum += one;
    for (double& one : x) one -= sum / static_cast<double>(x.size());
    return spectrum_of(x, 0.0, 1.0, true);
  };
  const Spectrum of_v = lines(v), of_first = lines(first), of_second = lines(second);
  double apart = 0.0;
  int turned = 0;
  for (std::size_t k = 0; k < of_v.amplitude.size(); ++k) {
    EXPECT_NEAR(of_first.amplitude[k], of_v.amplitude[k], 1e-13) << k;
    turned += std::abs(of_first.phase_deg[k] - of_v.phase_deg[k]) > 20.0 ? 1 : 0;
    apart += std::cos((of_first.phase_deg[k] - of_second.phase_deg[k]) * kPi / 180.0);
  }
  EXPECT_GT(turned, 20);
  EXPECT_LT(std::abs(apart), 16.0);  // of 33, were they alike
}

}  // namespace
}  // namespace bodesmith
