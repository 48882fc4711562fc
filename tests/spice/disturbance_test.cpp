#include <gtest/gtest.h>

#include "circuit/layout.hpp"
#include "spice/layout_check.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith {
namespace {

TEST(DisturbanceLibrary, NgspiceMakesThePolynomialsAndFollowsATriangleUpTo5Kilohertz) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  Disturbance wanted;
  wanted.ascending = {0.3546, -0.6433, 0.2887};
  wanted.descending = {-0.2398, 0.0838, 0.156};
  const LayoutCheck check =
      check_layout_with_ngspice(layout_disturbance(wanted), {Hertz{1}, Hertz{100}, Hertz{5000}});
  EXPECT_LT(check.static_percent, 0.04);
  EXPECT_LT(check.static_against_program, 5e-4);
  ASSERT_EQ(check.dynamic.size(), 3u);
  for (const LayoutCheck::Dynamic& one : check.dynamic) {
    // Late by a few per mille of a period up to 100 Hz, by 6 microseconds at 5 kHz.
    const bool fast = one.frequency.value > 1000.0;
    EXPECT_LT(one.late_share, fast ? 0.035 : 0.004) << one.frequency.value << " Hz";
    EXPECT_LT(one.rms_percent, fast ? 0.2 : 0.02) << one.frequency.value << " Hz";
  }
}

TEST(DisturbanceLibrary, DegreeSevenAndOneBranch) {
  if (!ngspice_available()) GTEST_SKIP() << "ngspice is not installed";
  const std::vector<double> seven = {0.3, -0.2, -0.2, 0.1, -0.1, 0.05, 0.05};
  const LayoutCheck two =
      check_layout_with_ngspice(layout_polynomials({{"up", seven}, {"down", {-0.2, 0.2}}}), {Hertz{5000}});
  EXPECT_LT(two.static_against_program, 5e-4);
  EXPECT_LT(two.static_percent, 0.1);
  EXPECT_LT(two.dynamic[0].rms_percent, 1.0);
  const LayoutCheck one =
      check_layout_with_ngspice(layout_polynomials({{"only", {0.1, -0.1, 0.2}}}), {Hertz{100}});
  EXPECT_LT(one.static_against_program, 5e-4);
  EXPECT_TRUE(one.dynamic.empty());
}

}  // namespace
}  // namespace bodesmith
