#include "tracking/reference.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace bodesmith::tracking {
namespace {

// The stroke of a triangle, which makes twice of it a period, with the slope of the slowest way.
TEST(Reference, LeastSwingIsThatOfItsSlowestWay) {
  EXPECT_DOUBLE_EQ(Reference(Reference::Shape::triangle, 0.7).least_swing(), 0.7);
  EXPECT_NEAR(Reference(Reference::Shape::decaying_triangle, 0.5).least_swing(), 0.5 * 0.2, 1e-12);
  EXPECT_NEAR(Reference(Reference::Shape::sine).least_swing(), 0.5 * std::numbers::pi, 2e-3);
  // Between its inner turns: in the middle of them the slope is pi/3 of the stroke a turn.
  EXPECT_NEAR(Reference(Reference::Shape::two_tone).least_swing(), std::numbers::pi / 6.0, 2e-3);
}

}  // namespace
}  // namespace bodesmith::tracking
