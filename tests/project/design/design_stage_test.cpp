// The curves of a design's stages: their columns, their plots, and what they differ by.
#include "project/design/design_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "signal/csv.hpp"

namespace bodesmith::project {
namespace {

/// A gain of 2, and three lags at 100 Hz behind it: 270 degrees in the end.
std::vector<DesignStage> stages() {
  return {
      {"ideal cascade", [](RadPerSecond) { return Complex(2.0); }},
      {"built-in lags",
       [](RadPerSecond w) { return 2.0 / std::pow(Complex(1.0, w.value / (200.0 * std::numbers::pi)), 3); },
       0}};
}

const std::vector<Hertz> kStageGrid = {Hertz{1.0},   Hertz{10.0}, Hertz{100.0},
                                       Hertz{300.0}, Hertz{1e3},  Hertz{1e5}};

double lag_db(double hz) {
  return 20.0 * std::log10(2.0) - 30.0 * std::log10(1.0 + hz * hz / 1e4);
}
double lag_degrees(double hz) {
  return -3.0 * std::atan(hz / 100.0) * 180.0 / std::numbers::pi;
}

TEST(DesignStages, ColumnsAreDecibelsAndDegreesOfEach) {
  const Csv csv = Csv::parse(stages_csv(stages(), kStageGrid), "bode.csv");
  for (std::size_t i = 0; i < kStageGrid.size(); ++i) {
    const double hz = kStageGrid[i].value;
    EXPECT_NEAR(csv.column("frequency_hz")[i], hz, 1e-6 * hz);
    EXPECT_NEAR(csv.column("ideal_cascade_magnitude_db")[i], 6.0206, 1e-4);
    EXPECT_NEAR(csv.column("built_in_lags_magnitude_db")[i], lag_db(hz), 1e-4);
    EXPECT_NEAR(std::remainder(csv.column("built_in_lags_phase_deg")[i] - lag_degrees(hz), 360.0), 0.0, 1e-3);
  }
}

TEST(DesignStages, PhaseIsPlottedWithoutJumpsAndPointsAreMarks) {
  BodePoints points;
  points.points = {{Hertz{10.0}, 2.0, {}}, {Hertz{100.0}, 0.5, {}}};
  const report::BodePlot plot = stages_bode(stages(), kStageGrid, &points);
  ASSERT_EQ(plot.magnitude.series.size(), 3U);
  ASSERT_EQ(plot.phase.series.size(), 2U);
  for (std::size_t i = 0; i < kStageGrid.size(); ++i) {
    EXPECT_NEAR(plot.magnitude.series[1].y[i], lag_db(kStageGrid[i].value), 1e-9);
    EXPECT_NEAR(plot.phase.series[1].y[i], lag_degrees(kStageGrid[i].value), 1e-9);
    EXPECT_EQ(plot.phase.series[1].x[i], kStageGrid[i].value);
  }
  EXPECT_EQ(plot.magnitude.series[2].x, (std::vector<double>{10.0, 100.0}));
  EXPECT_NEAR(plot.magnitude.series[2].y[1], -6.0206, 1e-4);
  EXPECT_EQ(stages_bode(stages(), kStageGrid, nullptr).magnitude.series.size(), 2U);
}

TEST(DesignStages, ADifferenceIsLessTheReferenceAndScaledByTheBand) {
  const report::BodePlot plot = stages_bode(stages(), kStageGrid, nullptr);
  const auto two = [](Hertz) { return 20.0 * std::log10(2.0); };
  const report::Plot difference =
      difference_plot(plot.magnitude, "Difference", {Hertz{10.0}, Hertz{300.0}}, two, "ideal cascade");
  ASSERT_EQ(difference.series.size(), 1U);
  EXPECT_EQ(difference.series[0].name, "built-in lags");
  for (std::size_t i = 0; i < kStageGrid.size(); ++i)
    EXPECT_NEAR(difference.series[0].y[i], lag_db(kStageGrid[i].value) - 20.0 * std::log10(2.0), 1e-9);
  // At 300 Hz, the band's end, it is 30 dB.
  EXPECT_TRUE(difference.y.fixed);
  EXPECT_NEAR(difference.y.to, 1.15 * 30.0, 1e-9);
  EXPECT_NEAR(difference.y.from, -1.15 * 30.0, 1e-9);
  EXPECT_EQ(difference_plot(plot.magnitude, "", {Hertz{10.0}, Hertz{300.0}}, two, "").series.size(), 2U);
}

}  // namespace
}  // namespace bodesmith::project
