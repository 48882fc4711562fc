// A model that was found on the training records and whose output grows without bound on the held-out ones: that is a figure of the
// report and no error.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "base/documents/json.hpp"
#include "gap/diagnosis.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/report/files.hpp"
#include "gap/report/size.hpp"

namespace bodesmith {
namespace {

TEST(RunsAway, OnTheHeldOutRecordsIsTold) {
  const std::string linear =
      "[[block]]\ntype = \"resonator\"\ngain = 1.0\nnatural_frequency_hz = 60.0\ndamping_ratio = 0.2\n";
  // Softening: beyond 1/sqrt(0.1) nothing holds it. What was held out kept to a straight line.
  const auto study =
      gap::Study::of({measured(linear + "cubic = -0.1\n", two_sines(400, 0.7, 8.0), 1e-3, 1e-3, 1),
                      measured(linear + "cubic = -0.1\n", two_sines(400, 0.6, 15.0), 1e-3, 1e-3, 2)},
                     {measured(linear, two_sines(400, 8.0, 11.0), 1e-3, 1e-3, 3)}, model_of(linear));
  const auto d = gap::diagnose(model_of(linear), study, {});
  ASSERT_EQ(d.steps.size(), 1U);
  EXPECT_EQ(d.steps[0].effect, "cubic_stiffness");
  EXPECT_EQ(d.verdict, gap::Verdict::partly_explained);
  EXPECT_TRUE(std::isinf(d.final.holdout_rms));
  EXPECT_LT(d.final.train_rms, 1.2e-3);
  EXPECT_TRUE(d.remaining_where.empty());
  EXPECT_NE(d.advice.find("grows without bound"), std::string::npos);
  const auto json = gap::to_json(d);
  EXPECT_TRUE(json["gap"]["final"]["holdout_rms"].is_null());
  EXPECT_TRUE(json["gap"]["refitted"]["holdout_rms"].is_number());
  EXPECT_EQ(gap::report_page(d, study).find("NaN"), std::string::npos);
}

}  // namespace
}  // namespace bodesmith

// A held-out record whose zero has moved: said, with its size.
namespace {

using namespace bodesmith;

/// y = 2 u + offset + noise of .01.
TimeRecord line_with(const char* file, unsigned seed, double offset) {
  return of_smoothed_noise(file, seed, 600, 1e-3, [&](int, double x, double e) {
    return std::pair(x, 2.0 * x + offset + 0.01 * e);
  });
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
