#include "chain/chain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bodesmith::chain {
namespace {
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Trained trained() {
  Trained out;
  out.input = {.lower = -1.0, .upper = 3.0, .max_rate_per_s = 20.0, .from_hz = 1.0, .to_hz = 40.0};
  out.output_lower = 0.0;
  out.output_upper = 8.0;
  return out;
}

// Each limit by itself: what lies within the records' own is not told, what lies beyond is, alone.
TEST(Trained, EachRespectInWhichADriveGoesBeyondTheRecordsIsTold) {
  const Trained records = trained();
  const SignalExtent inside = records.input;
  EXPECT_TRUE(records.beyond(inside, 0.0, 8.0).empty());
  SignalExtent drive = inside;
  drive.lower = -1.1;
  EXPECT_THAT(records.beyond(drive, 0.0, 8.0), ElementsAre(HasSubstr("goes down to -1.1")));
  drive = inside;
  drive.upper = 3.1;
  EXPECT_THAT(records.beyond(drive, 0.0, 8.0), ElementsAre(HasSubstr("goes up to 3.1")));
  drive = inside;
  drive.max_rate_per_s = 23.0;
  EXPECT_THAT(records.beyond(drive, 0.0, 8.0), ElementsAre(HasSubstr("rate a second goes up to 23")));
  drive = inside;
  drive.to_hz = 61.0;
  EXPECT_THAT(records.beyond(drive, 0.0, 8.0), ElementsAre(HasSubstr("frequencies in Hz go up to 61")));
  EXPECT_THAT(records.beyond(inside, -0.1, 8.0), ElementsAre(HasSubstr("reference goes down to -0.1")));
  EXPECT_THAT(records.beyond(inside, 0.0, 8.1), ElementsAre(HasSubstr("reference goes up to 8.1")));
  drive.upper = 5.0;
  EXPECT_EQ(records.beyond(drive, -1.0, 9.0).size(), 4u);
}

TEST(Trained, FarBeyondIsATenthOfTheRange) {
  const Trained records = trained();
  SignalExtent drive = records.input;
  drive.upper = 3.39;
  drive.lower = -1.39;
  EXPECT_EQ(records.far_beyond(drive), "");
  drive.upper = 3.41;
  EXPECT_THAT(records.far_beyond(drive), HasSubstr("-1.39 to 3.41"));
  drive.upper = 0.0;
  drive.lower = -1.41;
  EXPECT_THAT(records.far_beyond(drive), HasSubstr("-1.41 to 0"));
}

}  // namespace
}  // namespace bodesmith::chain
