#include "fit/choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/text.hpp"

namespace bodesmith {
namespace {

/// 30 points of the RIAA curve, rounded to .01 dB as a person types them.
BodePoints typed_curve() {
  BodePoints out;
  for (int i = 0; i < 30; ++i) {
    const double f = 20.0 * std::pow(1000.0, i / 29.0);
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
    const double db = to_decibel(std::abs((1.0 + s * 318e-6) / ((1.0 + s * 3180e-6) * (1.0 + s * 75e-6))));
    out.points.push_back({Hertz{f}, from_decibel(0.01 * std::round(100.0 * db)), {}, 1.0, 0});
  }
  return out;
}

TEST(FitChoice, ATypedCurveIsNotInterpolated) {
  const BodePoints points = typed_curve();
  const auto reason = why_unusable(fit_cascade(points));
  ASSERT_TRUE(reason);
  EXPECT_NE(reason->find("29 bands"), std::string::npos) << *reason;
  const FitChoice choice = choose_fit(points, {}, {}, 0.05);
  ASSERT_TRUE(choice.sections) << choice.why;
  EXPECT_EQ(choice.sections->sections.pole_count(), 2);
  EXPECT_LT(choice.sections->max_db, 0.01);
  EXPECT_NE(choice.why.find("2 poles directly meet 0.05 dB"), std::string::npos) << choice.why;
}

TEST(FitChoice, FewBandsStayACascade) {
  BodePoints points;
  for (const auto& [f, g] : {std::pair{1.0, 1.0}, {10.0, 1.06}, {20.0, 1.1}, {60.0, 1.04}, {100.0, 1.17}})
    points.points.push_back({Hertz{f}, g, {}, 1.0, 0});
  EXPECT_FALSE(why_unusable(fit_cascade(points)));
}

// The paper's chart splits, in its middle, the band that ends at the point of the largest error.
TEST(ChartedFit, SplitsTheBandThatErrsMost) {
  BodePoints points;
  for (const auto& [f, g] : {std::pair{1.0, 7.64}, {5.03, 7.8}, {29.4, 4.49}, {180.49, 4.34}, {198.54, 4.9}})
    points.points.push_back({Hertz{f}, g, {}, 1.0, 0});
  double from = 1.0, most = -1.0, middle = 0.0;
  for (const Cascade::FitPoint& point : fit_cascade(points, {.beta_max = kChartBound}).cascade.fit->points) {
    const double error = std::abs(point.got_db - point.wanted_db);
    if (error > most) {
      most = error;
      middle = std::sqrt(from * point.frequency.value);
    }
    from = point.frequency.value;
  }
  const ChartedFit charted = fit_by_chart(points, {});
  ASSERT_GT(charted.steps.size(), 1u);
  EXPECT_NE(charted.steps[1].find("split at " + rounded_text(middle) + " Hz"), std::string::npos)
      << charted.steps[1];
  EXPECT_LT(charted.fit.cascade.fit->max_db, 0.9 * most);
}

// What two poles make exactly no bands do: within a wide limit the fewer poles are taken, whichever they are.
TEST(FitChoice, TakesBandsWhereTheyNeedFewerPoles) {
  BodePoints points;
  for (int i = 0; i <= 12; ++i) {
    const double f = 10.0 * std::pow(10.0, i / 4.0);
    const std::complex<double> s(0.0, f / 300.0);
    points.points.push_back({Hertz{f}, std::pow(std::abs((1.0 + s) / (1.0 + s / 10.0)), 0.3), {}, 1.0, 0});
  }
  const FitChoice choice = choose_fit(points, {}, {}, 1.0);
  EXPECT_NE(choice.cascade.has_value(), choice.sections.has_value());
  const int bands = choice.cascade ? least_poles(*choice.cascade) : 99;
  const double left = choice.cascade ? choice.cascade->cascade.fit->max_db : choice.sections->max_db;
  EXPECT_LE(left, 1.0) << choice.why;
  if (choice.sections) {
    EXPECT_LE(choice.sections->sections.pole_count(), bands);
  }
}

}  // namespace
}  // namespace bodesmith
