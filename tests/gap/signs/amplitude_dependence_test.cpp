// Responses at several drives: what no linear effect does is told, and what kind it is.
#include <gtest/gtest.h>

#include "gap/diagnosis.hpp"
#include "gap/made_response.hpp"
#include "gap/signs/amplitude_dependence.hpp"

namespace {

using namespace bodesmith;
using gap::AmplitudeClass;

/// Harmonic balance of y'' + 2 z w y' + w^2 (y + c y^3) = w^2 u at the drive A: 3/4 c |Y|^2 more stiffness.
made::Response duffing(double cubic, double drive) {
  return [=](double hz) {
    const double r = hz / 100.0;
    double size = 0.0;
    made::Complex h;
    for (int i = 0; i < 300; ++i) {
      h = 1.0 / made::Complex(1.0 - r * r + 0.75 * cubic * size * size, 2.0 * 0.05 * r);
      size += 0.2 * (std::abs(h) * drive - size);
    }
    return h;
  };
}

/// Describing function of a saturation at `limit`, in front of a lag.
made::Response saturated(double limit, double drive) {
  const double k = std::min(1.0, limit / drive);
  const double gain = 2.0 / std::numbers::pi * (std::asin(k) + k * std::sqrt(1.0 - k * k));
  return [=](double hz) { return gain * made::lag(hz, 200.0); };
}

FrequencyRecord at(const made::Response& h, double drive, std::uint64_t seed) {
  auto record = made::measured(
      h, 10.0, 1000.0, 120, [](double) { return 0.003; }, seed);
  record.drive_v.assign(record.frequency.size(), drive);
  return record;
}

gap::Experiments two(const made::Response& small, const made::Response& large) {
  return {gap::FrequencyExperiment(at(small, 0.01, 1)), gap::FrequencyExperiment(at(large, 0.1, 2))};
}

TEST(AmplitudeDependence, SofteningAndHardeningAreToldByThePeak) {
  const auto softer = gap::amplitude_dependence(two(duffing(-0.1, 0.01), duffing(-0.1, 0.1)));
  ASSERT_TRUE(softer.has_value());
  EXPECT_EQ(softer->kind, AmplitudeClass::softening_stiffness);
  EXPECT_LT(*softer->peak_at_largest_hz, *softer->peak_at_least_hz);
  const auto harder = gap::amplitude_dependence(two(duffing(0.1, 0.01), duffing(0.1, 0.1)));
  ASSERT_TRUE(harder.has_value());
  EXPECT_EQ(harder->kind, AmplitudeClass::hardening_stiffness);
}

TEST(AmplitudeDependence, ALimitLowersTheGain) {
  const auto found = gap::amplitude_dependence(two(saturated(0.08, 0.01), saturated(0.08, 0.1)));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->kind, AmplitudeClass::falling_gain);
  // k = .8: 2/pi (asin k + k sqrt(1 - k^2)) = .896.
  EXPECT_NEAR(found->change, 0.110, 0.003);
}

TEST(AmplitudeDependence, ALinearSystemHasNone) {
  for (std::uint64_t seed = 1; seed < 30; seed += 2) {
    const gap::Experiments both = {gap::FrequencyExperiment(at(duffing(0.0, 1.0), 0.01, seed)),
                                   gap::FrequencyExperiment(at(duffing(0.0, 1.0), 0.1, seed + 1))};
    EXPECT_FALSE(gap::amplitude_dependence(both).has_value()) << seed;
  }
}

/// A mode at 100 Hz.
made::Response mode_of(double damping) {
  return [=](double hz) { return made::mode(hz, 100.0, damping); };
}

AmplitudeClass kind_of(const made::Response& small, const made::Response& large) {
  const auto found = gap::amplitude_dependence(two(small, large));
  EXPECT_TRUE(found.has_value());
  return found ? found->kind : AmplitudeClass::falling_gain;
}

TEST(AmplitudeDependence, TheKindIsWhereTheGainChanges) {
  EXPECT_EQ(kind_of(mode_of(0.03), mode_of(0.06)), AmplitudeClass::rising_damping);
  EXPECT_EQ(kind_of(mode_of(0.06), mode_of(0.03)), AmplitudeClass::falling_damping);
  // So much damping moves the peak by 2 %, half a step of the grid, and is no stiffness.
  EXPECT_EQ(kind_of(mode_of(0.05), mode_of(0.15)), AmplitudeClass::rising_damping);
  const auto scaled = [](double gain, double damping) -> made::Response {
    return [=](double hz) { return gain * made::mode(hz, 100.0, damping); };
  };
  EXPECT_EQ(kind_of(scaled(1.0, 0.05), scaled(1.2, 0.05)), AmplitudeClass::rising_gain);
  EXPECT_EQ(kind_of(scaled(1.0, 0.05), scaled(0.8, 0.05)), AmplitudeClass::falling_gain);
  const auto lag = [](double corner) -> made::Response {
    return [=](double hz) { return made::lag(hz, corner); };
  };
  EXPECT_EQ(kind_of(lag(2000.0), lag(300.0)), AmplitudeClass::falling_gain_at_top);
  EXPECT_EQ(kind_of(lag(300.0), lag(2000.0)), AmplitudeClass::rising_gain);
}

TEST(AmplitudeDependence, PeaksStandWhereTheyAreAndDrivesAreTold) {
  const auto stiff = [](double hz_of_mode) -> made::Response {
    return [=](double hz) { return made::mode(hz, hz_of_mode, 0.02); };
  };
  const auto found = gap::amplitude_dependence(two(stiff(100.0), stiff(107.0)));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->kind, AmplitudeClass::hardening_stiffness);
  EXPECT_NEAR(*found->peak_at_least_hz, 100.0, 0.6);
  EXPECT_NEAR(*found->peak_at_largest_hz, 107.0, 0.6);
  EXPECT_DOUBLE_EQ(found->least_drive_v, 0.01);
  EXPECT_DOUBLE_EQ(found->largest_drive_v, 0.1);
  // Which record is named first decides nothing; the response at the larger drive is known where it was measured alone.
  auto both = two(stiff(100.0), stiff(107.0));
  std::swap(both[0], both[1]);
  const auto turned = gap::amplitude_dependence(both);
  ASSERT_TRUE(turned.has_value());
  EXPECT_EQ(turned->kind, found->kind);
  EXPECT_DOUBLE_EQ(turned->change, found->change);
}

TEST(AmplitudeDependence, OnlyTheLeastDriveIsKept) {
  const auto flat = [](double) { return made::Complex(1.0); };
  const auto of = [&](double drive) { return gap::FrequencyExperiment(at(flat, drive, 1)); };
  auto bare = at(flat, 0.0, 1);
  bare.drive_v.clear();
  const auto drives = [](const gap::Experiments& all) {
    std::vector<double> out;
    for (const auto& e : gap::of_least_drive(all)) {
      const auto& drive = std::get<gap::FrequencyExperiment>(e).record().drive_v;
      out.push_back(drive.empty() ? 0.0 : drive.front());
    }
    return out;
  };
  EXPECT_EQ(drives({of(0.1), of(0.0103), of(0.01), gap::FrequencyExperiment(bare), of(0.011)}),
            (std::vector<double>{0.0103, 0.01, 0.011}));
  EXPECT_EQ(drives({gap::FrequencyExperiment(bare)}), std::vector<double>{0.0});
  // One drive tells nothing.
  EXPECT_FALSE(gap::amplitude_dependence({gap::FrequencyExperiment(at(mode_of(0.03), 0.01, 1)),
                                          gap::FrequencyExperiment(at(mode_of(0.06), 0.01, 2))}));
}

TEST(AmplitudeDependence, IsNeverExplained) {
  // A lag that is missing is found at the least drive; the limit is told as what no linear effect does.
  const auto base = made::free_gain(0.9);
  const auto study =
      gap::Study::of(std::vector{at(saturated(0.08, 0.01), 0.01, 5), at(saturated(0.08, 0.1), 0.1, 6)},
                     std::vector{at(saturated(0.08, 0.01), 0.01, 7)}, base);
  const auto d = gap::diagnose(base, study, {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "amplifier_pole");
  EXPECT_EQ(d.verdict, gap::Verdict::partly_explained);
  ASSERT_TRUE(d.amplitude.has_value());
  EXPECT_NE(d.advice.find("ime records"), std::string::npos) << d.advice;
}

}  // namespace
