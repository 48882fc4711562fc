// Points of little coherence count less: in fits, in the floor, in the verdict.
#include <gtest/gtest.h>

#include "gap/diagnosis.hpp"
#include "gap/made_response.hpp"
#include "gap/records/response_weights.hpp"
#include "signal/statistics.hpp"

namespace {

using namespace bodesmith;

constexpr double kAverages = 20.0;
constexpr double kGood = 0.004;
constexpr double kBad = 0.25;
constexpr double kSplitHz = 70.0;

double noise_at(double hz) {
  return hz > kSplitHz ? kBad : kGood;
}

/// A slow relaxation of a twentieth, below kSplitHz; the upper half of the band is noise for the most part.
FrequencyRecord half_bad(std::uint64_t seed, bool with_coherence) {
  const auto h = [](double hz) { return 2.0 * (1.0 + 0.05 * made::lag(hz, 20.0)); };
  auto record = made::measured(h, 5.0, 1000.0, 200, noise_at, seed);
  for (std::size_t i = 0; with_coherence && i < record.frequency.size(); ++i) {
    // Variance of a part (1 - g)/(2 n g), solved for g.
    const double v = std::pow(noise_at(record.frequency[i].value), 2);
    record.coherence.push_back(1.0 / (1.0 + 2.0 * kAverages * v));
    record.averages.push_back(kAverages);
  }
  return record;
}

gap::Diagnosis diagnosed(bool with_coherence) {
  const auto base = made::free_gain(1.9);
  const auto study = gap::Study::of(std::vector{half_bad(11, with_coherence)},
                                    std::vector{half_bad(12, with_coherence)}, base);
  return gap::diagnose(base, study, {});
}

TEST(Coherence, WeightsAreTheInverseDeviations) {
  const auto record = half_bad(1, true);
  const auto weights = gap::response_weights(record);
  ASSERT_EQ(weights.size(), record.frequency.size());
  EXPECT_NEAR(rms(weights), 1.0, 1e-12);
  EXPECT_NEAR(weights.front() / weights.back(), kBad / kGood, 1e-6 * kBad / kGood);
}

TEST(Coherence, ACoherenceOfOneIsNoBetterThanTheRestByMuch) {
  auto record = half_bad(1, true);
  record.coherence.front() = 1.0;
  const auto weights = gap::response_weights(record);
  EXPECT_LT(weights.front() / weights[1], 4.0);
  EXPECT_GT(weights.front() / weights[1], 2.0);
}

TEST(Coherence, TellsTheNoiseWhereTheAveragesAreKnown) {
  auto record = half_bad(1, true);
  const auto noise = gap::noise_by_coherence(record);
  ASSERT_TRUE(noise.has_value());
  const auto weights = gap::response_weights(record);
  EXPECT_NEAR(*noise, weights.front() * kGood, 1e-6);
  record.averages.clear();
  EXPECT_FALSE(gap::noise_by_coherence(record).has_value());
}

TEST(Coherence, FindsWhatHalfABandOfNoiseWouldHide) {
  const auto with = diagnosed(true);
  ASSERT_EQ(with.steps.size(), 1U);
  EXPECT_EQ(with.verdict, gap::Verdict::explained);
  EXPECT_EQ(with.floor.source, gap::NoiseFloor::Source::periods);
  EXPECT_LT(with.final.train_rms, 1.2 * with.floor.rms);
  EXPECT_GT(with.final.train_rms, 0.8 * with.floor.rms);
  EXPECT_TRUE(with.weighted);
  EXPECT_TRUE(diagnosed(false).steps.empty());
}

}  // namespace
