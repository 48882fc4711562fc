#include "signal/time_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/error.hpp"

namespace bodesmith {
namespace {

TEST(TimeRecord, SizesWhoseSquaresLeaveADoublesRangeAreRefused) {
  const auto sized = [](double u, double y) { return TimeRecord{"r.csv", 0.0, 1.0, {0.0, u}, {0.0, y}}; };
  for (const double size : {0.0, 1e-49, 1.0, 1e49})
    EXPECT_NO_THROW(sized(size, -size).require_measured_sizes());
  for (const double size : {1e-51, 1e51}) {
    EXPECT_THROW(sized(-size, 1.0).require_measured_sizes(), InputError);
    EXPECT_THROW(sized(1.0, size).require_measured_sizes(), InputError);
  }
}

TEST(TimeRecord, TheInputsExtentIsThatOfWhatIsNotSkipped) {
  const std::vector<TimeRecord> records = {{"a", 0.0, 0.5, {-9.0, 0.0, 5.0, 6.0}, {}},
                                           {"b", 0.0, 0.5, {7.0, 1.0, 3.0}, {}}};
  const SignalExtent seen = input_extent(records, 0.5);
  EXPECT_EQ(seen.lower, 0.0);
  EXPECT_EQ(seen.upper, 6.0);
  EXPECT_EQ(seen.max_rate_per_s, 10.0);
  EXPECT_EQ(input_extent(records).max_rate_per_s, 18.0);
  // The last sample counts however much is skipped.
  const SignalExtent last = input_extent(records, 1e9);
  EXPECT_EQ(last.lower, 3.0);
  EXPECT_EQ(last.upper, 6.0);
}

TEST(TimeRecord, TheInputsBandIsThatOfItsChanges) {
  TimeRecord record{"r", 0.0, 1e-3, {}, {}};
  for (int i = 0; i < 2000; ++i)
    record.u.push_back(std::sin(2.0 * std::numbers::pi * 5.0e-3 * i) +
                       0.5 * std::sin(2.0 * std::numbers::pi * 40.0e-3 * i));
  const auto band = [&](double offset) {
    TimeRecord moved = record;
    for (double& u : moved.u) u += offset;
    return input_extent(std::vector{moved});
  };
  EXPECT_NEAR(band(0.0).from_hz, 5.0, 1.0);
  EXPECT_NEAR(band(0.0).to_hz, 40.0, 1.0);
  EXPECT_EQ(band(30.0).from_hz, band(0.0).from_hz);
  EXPECT_EQ(band(30.0).to_hz, band(0.0).to_hz);
  // Of two records: from the lower to the higher, whichever comes first.
  TimeRecord slow = record;
  for (std::size_t i = 0; i < slow.u.size(); ++i)
    slow.u[i] = std::sin(2.0 * std::numbers::pi * 2.0e-3 * static_cast<double>(i));
  for (const auto& both : {std::vector{record, slow}, std::vector{slow, record}}) {
    EXPECT_NEAR(input_extent(both).from_hz, 2.0, 0.6);
    EXPECT_NEAR(input_extent(both).to_hz, 40.0, 1.0);
  }
}

}  // namespace
}  // namespace bodesmith
