#include "fpaa/controller/branches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {
namespace {

// The table holds what the line leaves of d, to full scale where that is greatest; table and line together are d again.
TEST(TableShape, LineAndTableAreTheDisturbanceToFullScale) {
  Disturbance d;
  d.ascending = {0.3546, -0.6433, 0.2887};  // returns to 0: a line does not pay
  d.descending = {-0.6, 0.15, 0.02};        // nearly straight
  const DriveRange range{-0.1, 1.05, {}};
  const VoltScale scale{5.0, 0.475};
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    const TableShape shape = table_shape(d, branch, range, scale);
    EXPECT_EQ(shape.line != 0.0, branch == Disturbance::Branch::descending);
    double greatest = 0.0, most_v = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      const double x = range.low + (range.high - range.low) * i / 1000.0;
      const double left = d.value(branch, x) - shape.line * (x - scale.centre);
      greatest = std::max(greatest, std::abs(left));
      const double volts = table_volts(d, branch, shape, scale, scale.volts(x));
      most_v = std::max(most_v, std::abs(volts));
      EXPECT_NEAR(volts, -3.0 * left / shape.greatest, 1e-12);
    }
    EXPECT_NEAR(shape.greatest, greatest, 1e-3 * greatest);
    EXPECT_NEAR(most_v, 3.0, 3e-3);
    if (shape.line == 0.0) continue;
    // Of the chord from end to end.
    EXPECT_NEAR(shape.line,
                (d.value(branch, range.high) - d.value(branch, range.low)) / (range.high - range.low), 1e-12);
  }
  EXPECT_EQ(table_volts(Disturbance(), Disturbance::Branch::ascending, TableShape(), scale, 1.0), 0.0);
}

}  // namespace
}  // namespace bodesmith::fpaa
