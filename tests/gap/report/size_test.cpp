// A model that was found on the training records and whose output grows without bound on the held-out ones: that is a figure of the
// report and no error.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/documents/json.hpp"
#include "gap/diagnosis.hpp"
#include "gap/made_record.hpp"
#include "gap/report/files.hpp"

namespace bodesmith {
namespace {

TEST(RunsAway, onTheHeldOutRecordsIsTold) {
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
