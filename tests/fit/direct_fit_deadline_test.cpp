// A direct fit that may take no time keeps the best so far and says what it left.
#include <gtest/gtest.h>

#include <cmath>

#include "fit/direct_fit.hpp"

namespace bodesmith {
namespace {

/// A wavy slope that no fit of low order meets, so that nothing is proven and all starts would be followed.
BodePoints wavy_points() {
  BodePoints points;
  for (int i = 0; i < 60; ++i) {
    const double f = 10.0 * std::pow(1000.0, i / 59.0);
    points.points.push_back({Hertz{f}, (1.0 + 0.1 * std::sin(2.3 * i)) / std::sqrt(f), std::nullopt, 1.0, 0});
  }
  return points;
}

TEST(DirectFitDeadline, KeepsTheBestSoFarAndNamesWhatWasLeft) {
  DirectFitOptions options{.order = 3};
  options.least_squares = true;
  const DirectFit whole = fit_directly(wavy_points(), options);
  EXPECT_TRUE(whole.not_tried.empty());
  options.deadline = Deadline(1e-9);
  const DirectFit hurried = fit_directly(wavy_points(), options);
  EXPECT_FALSE(hurried.not_tried.empty());
  EXPECT_TRUE(std::isfinite(hurried.max_db));
  EXPECT_LT(hurried.rms_db, 3.0);
  for (const Section& section : hurried.sections.sections)
    for (const auto& pole : section.poles) EXPECT_LT(pole.real(), 0.0);
}

TEST(DirectFitDeadline, EndsTheSearchForAnOrderToo) {
  DirectFitOptions options;
  options.deadline = Deadline(1e-9);
  const DirectFit fit = fit_directly_within(wavy_points(), options, 1e-6, 1, 12);
  ASSERT_FALSE(fit.not_tried.empty());
  EXPECT_EQ(fit.not_tried.back(), "orders above 1");
}

TEST(Deadline, NeverPassesUnlessItIsSet) {
  EXPECT_FALSE(Deadline().passed());
  EXPECT_TRUE(Deadline(0.0).passed());
  EXPECT_FALSE(Deadline(1e300).passed());
}

}  // namespace
}  // namespace bodesmith
