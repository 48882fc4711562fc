// Relaxation that goes on long after the drive has moved is creep, a change of gain within the driven band is rate
// dependence, though a few numbers make one look like the other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gap/cases/signals.hpp"
#include "gap/cases/stages.hpp"
#include "gap/cases/time_base.hpp"
#include "gap/diagnosis.hpp"
#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"

namespace {

using namespace bodesmith;

constexpr std::size_t kRelaxedRows = 2000;
constexpr double kRelaxedStepS = 1e-3;
constexpr double kRelaxedBandHz = 30.0;

/// A record of the stages behind a gain of 2, with noise.
TimeRecord relaxed_record(const std::vector<hidden::Stage>& stages, hidden::Drive drive, unsigned seed) {
  hidden::Random random(seed);
  TimeRecord r;
  r.file = "record.csv";
  r.step_s = kRelaxedStepS;
  r.u = hidden::make_drive(drive, kRelaxedRows, kRelaxedStepS, kRelaxedBandHz, random);
  r.y = hidden::play_chain(stages, r.u, kRelaxedStepS);
  const auto noise = hidden::make_noise(hidden::Colour::white, kRelaxedRows, random);
  for (std::size_t i = 0; i < kRelaxedRows; ++i) r.y[i] = 2.0 * r.y[i] + 0.004 * noise[i];
  return r;
}

std::vector<std::string> names_of_relaxed(const std::vector<hidden::Stage>& stages) {
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.9\noffset = 0.0\nfree = [\"gain\"]\n");
  const auto study = gap::Study::of({relaxed_record(stages, hidden::Drive::noise, 1)},
                                    {relaxed_record(stages, hidden::Drive::multisine, 2)}, base);
  std::vector<std::string> all;
  for (const auto& s : gap::diagnose(base, study, {}).steps) all.push_back(s.effect);
  return all;
}

TEST(Relaxation, OfManyTimeConstantsIsCreep) {
  std::vector<double> gains;
  std::vector<double> times;
  for (int k = 0; k < 10; ++k) {
    gains.push_back(0.015);
    times.push_back(0.06 * std::pow(40.0, k / 9.0));
  }
  EXPECT_EQ(names_of_relaxed({hidden::creep(gains, times)}), std::vector<std::string>{"creep"});
}

TEST(Relaxation, WithinTheDrivenBandIsRateDependence) {
  const double slow = 1.0 / (2.0 * std::numbers::pi * 2.0);
  EXPECT_EQ(names_of_relaxed({hidden::fractional(slow, 0.03, -0.1)}),
            std::vector<std::string>{"rate_dependence"});
  EXPECT_EQ(names_of_relaxed({hidden::fractional(slow, 0.03, 0.1)}),
            std::vector<std::string>{"rate_dependence"});
}

}  // namespace
