// The same record in other units is the same record.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.hpp"
#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"

namespace {

using namespace bodesmith;

/// A Bouc-Wen loop of sharpness 1.5 behind a gain of 2, input and output in units of 1/scale.
TimeRecord loop_in_units(const char* file, unsigned seed, double scale) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = file;
  r.step_s = 1e-3;
  double x = 0.0;
  double z = 0.0;
  double before = 0.0;
  for (int i = 0; i < 900; ++i) {
    x += 0.08 * (normal(random) - x);
    const double u = std::tanh(3.0 * x);
    for (int k = 0; k < 10; ++k) {
      const double du = 0.1 * (u - before);
      z += 0.3 * du - 2.0 * std::abs(du) * std::sqrt(std::abs(z)) * z - 1.0 * du * std::pow(std::abs(z), 1.5);
    }
    before = u;
    r.u.push_back(scale * u);
    r.y.push_back(scale * (2.0 * (u - z) + 0.003 * normal(random)));
  }
  return r;
}

gap::Diagnosis diagnosis_in_units(double scale) {
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 1.8\nfree = [\"gain\"]\n");
  const auto study =
      gap::Study::of({loop_in_units("train.csv", 1, scale)}, {loop_in_units("holdout.csv", 2, scale)}, base);
  return gap::diagnose(base, study, {});
}

TEST(Units, decideNeitherNamesNorFigures) {
  const auto usual = diagnosis_in_units(1.0);
  ASSERT_FALSE(usual.steps.empty());
  EXPECT_EQ(usual.steps[0].effect, "hysteresis");
  for (const double scale : {1e-6, 1e6}) {
    const auto other = diagnosis_in_units(scale);
    ASSERT_EQ(other.steps.size(), usual.steps.size()) << scale;
    EXPECT_EQ(other.steps[0].effect, usual.steps[0].effect) << scale;
    EXPECT_EQ(other.steps[0].placed, usual.steps[0].placed) << scale;
    EXPECT_NEAR(other.final.holdout_rms / scale, usual.final.holdout_rms, 0.02 * usual.final.holdout_rms)
        << scale;
  }
}

TEST(Units, beyondWhatCubesAllowAreRefusedInAWord) {
  for (const double scale : {1e150, 1e-150}) {
    try {
      diagnosis_in_units(scale);
      ADD_FAILURE() << scale;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("train.csv"), std::string::npos);
      EXPECT_NE(std::string(e.what()).find("another unit"), std::string::npos);
    }
  }
}

}  // namespace
