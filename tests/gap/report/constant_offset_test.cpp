// A held-out record whose zero has moved: said, with its size.
#include "gap/report/size.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"

namespace {

using namespace bodesmith;

/// y = 2 u + offset + noise of .01.
TimeRecord line_with(const char* file, unsigned seed, double offset) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TimeRecord r;
  r.file = file;
  r.step_s = 1e-3;
  double x = 0.0;
  for (int i = 0; i < 600; ++i) {
    x += 0.1 * (normal(random) - x);
    r.u.push_back(x);
    r.y.push_back(2.0 * x + offset + 0.01 * normal(random));
  }
  return r;
}

gap::Diagnosis diagnosis_with(double offset) {
  const auto base = model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\nfree = [\"gain\"]\n");
  const auto study =
      gap::Study::of({line_with("train.csv", 1, 0.0)}, {line_with("holdout.csv", 2, offset)}, base);
  gap::SearchOptions options;
  options.max_terms = 0;
  return gap::diagnose(base, study, options);
}

TEST(ConstantOffset, OfAHeldOutRecordIsSaid) {
  const gap::Diagnosis moved = diagnosis_with(-0.05);
  ASSERT_EQ(moved.constant_offsets.size(), 1u);
  const gap::ConstantOffset& found = moved.constant_offsets[0];
  EXPECT_NEAR(found.value, -0.05, 0.002);
  EXPECT_NEAR(found.share, 0.0025 / 0.0026, 0.01);
  EXPECT_NEAR(found.rms_without, 0.01, 0.001);
  EXPECT_NE(moved.advice.find("A constant offset of -0.05"), std::string::npos) << moved.advice;
  EXPECT_NE(moved.advice.find("96 % of the gap that is left on holdout.csv"), std::string::npos)
      << moved.advice;
}

TEST(ConstantOffset, NoiseIsNone) {
  EXPECT_TRUE(diagnosis_with(0.0).constant_offsets.empty());
}

}  // namespace
