// Which of the board's controllers is taken, and what the ideal drives next to them leave.
#include "project/tracking/board_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "signal/csv.hpp"
#include "tracking/stage.hpp"

namespace bodesmith::project {
namespace {

using fpaa::ControllerStructure;
using fpaa::PolynomialBy;

BoardTrackingRow row(const std::string& key, std::optional<std::size_t> variant,
                     std::vector<double> percent) {
  BoardTrackingRow out;
  out.key = key;
  out.name = "the " + key;
  out.variant = variant;
  for (const double one : percent) {
    tracking::TrackingError error;
    error.rms_percent = 10.0 * one;
    error.max_percent = 3.0 * one;
    error.lag_s = 1e-6 * one;
    error.rms_percent_without_lag = one;
    out.at.push_back(error);
  }
  return out;
}

fpaa::ControllerVariant variant(PolynomialBy by, ControllerStructure structure, std::size_t cams) {
  fpaa::ControllerVariant out;
  out.by = by;
  out.structure = structure;
  out.cams.resize(cams);
  return out;
}

/// Four variants; the first does not run.
TrackedController four() {
  TrackedController out;
  out.controller.variants = {variant(PolynomialBy::outside, ControllerStructure::loop, 3),
                             variant(PolynomialBy::outside, ControllerStructure::two_pass, 9),
                             variant(PolynomialBy::multipliers, ControllerStructure::loop, 7),
                             variant(PolynomialBy::lookup, ControllerStructure::loop, 8)};
  out.tracking.frequency = {Hertz{1.0}, Hertz{100.0}};
  out.tracking.rows = {row("no_compensation", {}, {0.01, 0.01}),
                       row("constant_polynomial", {}, {0.2, 2.0}),
                       row("board_a", 0, {}),
                       row("board_b", 1, {0.5, 0.10}),
                       row("board_c", 2, {0.1, 0.52}),
                       row("board_d", 3, {0.1, 0.6})};
  out.tracking.rows[2].why_not = "too many cells";
  return out;
}

std::size_t chosen(TrackedController from, const fpaa::ControllerOptions& options = {}) {
  from.controller.chosen = 0;
  choose_by_tracking(from.controller, from.tracking, options);
  return from.controller.chosen;
}

TEST(BoardController, TheOneThatTracksBestIsTakenTiesByFewerCams) {
  EXPECT_EQ(chosen(four()), 2U) << "0.52 is within 5 % of 0.50, with two CAMs fewer";
  TrackedController from = four();
  from.tracking.rows[4] = row("board_c", 2, {0.1, 0.53});
  EXPECT_EQ(chosen(from), 1U) << "0.53 is not";
  from = four();
  from.controller.variants[2].cams.resize(9);
  EXPECT_EQ(chosen(from), 1U);
  fpaa::ControllerOptions options;
  options.polynomial = PolynomialBy::lookup;
  EXPECT_EQ(chosen(four(), options), 3U);
  options.polynomial.reset();
  options.structure = ControllerStructure::two_pass;
  EXPECT_EQ(chosen(four(), options), 1U);
  options.polynomial = PolynomialBy::multipliers;
  EXPECT_EQ(chosen(four(), options), 0U) << "as it was: no row is of both";
  from = four();
  choose_by_tracking(from.controller, from.tracking, {});
  EXPECT_EQ(from.worst_percent(), 0.52);
  EXPECT_NE(from.controller.why.find("0.52 % rms at worst over 1 to 100 Hz as the board runs (2 % with"),
            std::string::npos)
      << from.controller.why;
}

TEST(BoardController, WhatDidNotRunHasNoColumn) {
  const BoardTracking tracking = four().tracking;
  const Csv csv = Csv::parse(tracking.csv(), "tracking.csv");
  EXPECT_EQ(csv.column("frequency_hz")[1], 100.0);
  EXPECT_EQ(csv.column("board_c_percent")[1], 0.52);
  EXPECT_EQ(tracking.csv().find("board_a"), std::string::npos);
  const Json rows = tracking.to_json()["rows"];
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_EQ(rows[2]["why_not"], "too many cells");
  EXPECT_FALSE(rows[2].contains("rms_percent"));
  EXPECT_EQ(rows[3]["rms_percent"], (Json{0.5, 0.1}));
  EXPECT_EQ(rows[3]["rms_percent_with_lag"], (Json{5.0, 1.0}));
  EXPECT_FALSE(rows[3].contains("why_not"));
}

/// A stage that goes where it is driven.
class Rigid final : public tracking::Stage {
 public:
  const std::string& name() const override { return name_; }
  std::vector<double> response(std::span<const double> v, double, Hertz, tracking::DriveKind) const override {
    return {v.begin(), v.end()};
  }

 private:
  std::string name_ = "rigid";
};

// On a stage without hysteresis nothing is best left alone, and the polynomial's error is the disturbance's own size.
TEST(BoardController, IdealDrivesAreTheReferenceAndThatLessTheDisturbance) {
  Disturbance disturbance;
  disturbance.ascending = {0.3, -0.6, 0.3};
  disturbance.descending = {-0.2, 0.1, 0.1};
  const BoardTracking tracked =
      track_board(fpaa::Controller{}, disturbance, Rigid(), {Hertz{3.0}}, tracking::Reference());
  ASSERT_EQ(tracked.rows.size(), 2U);
  EXPECT_EQ(tracked.rows[0].key, "no_compensation");
  EXPECT_LT(tracked.rows[0].worst_percent(), 1e-9);
  EXPECT_EQ(tracked.rows[1].key, "constant_polynomial");
  // r goes up and down evenly: mean squares over x in [0, 1], and the range of r - d(r).
  double square = 0.0, low = 0.0, high = 0.0;
  constexpr int kMidpoints = 20000;
  for (int i = 0; i < kMidpoints; ++i) {
    const double x = (i + 0.5) / kMidpoints;
    for (const auto& a : {disturbance.ascending, disturbance.descending}) {
      const double d = x * (a[0] + x * (a[1] + x * a[2]));
      square += d * d / (2.0 * kMidpoints);
      low = std::min(low, x - d);
      high = std::max(high, x - d);
    }
  }
  EXPECT_NEAR(tracked.rows[1].at[0].rms_percent, 100.0 * std::sqrt(square) / (high - low), 0.01);
}

}  // namespace
}  // namespace bodesmith::project
