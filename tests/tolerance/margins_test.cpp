#include "tolerance/margins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/documents/json.hpp"

namespace bodesmith::tolerance {
namespace {

/// A gain of 1 within a tolerance, before the plant K / (s (1 + s)^2), s in rad/s.
struct GainLoop {
  Design design;
  Options options;
  std::vector<Hertz> grid = log_grid({Hertz{1e-3}, Hertz{10.0}}, 800);
  double gain;

  GainLoop(double k, double percent) : gain(k) {
    design.name = "gain";
    design.parts = {{"R2", Part::Kind::resistor, 1000.0}};
    design.stages = {{"s", 0, 1, [](std::span<const double> v) {
                        return synthesis::Biquad{v[0] / 1000.0, 0, 0, 1, 0, 0};
                      }}};
    design.wanted = [](Hertz) { return std::complex<double>(1.0, 0.0); };
    options.samples = 4000;
    options.spread.resistor_percent = percent;
  }
  LoopStudy study() const {
    std::vector<std::complex<double>> plant;
    for (const Hertz f : grid) {
      const std::complex<double> s(0.0, f.rad_s().value);
      plant.push_back(gain / (s * (1.0 + s) * (1.0 + s)));
    }
    return study_loop(design, options, grid, plant);
  }
};

/// Of the loop g / (s (1 + s)^2): |L| = 1 at w (1 + w^2) = g, where arg L = -90 deg - 2 atan w.
double phase_margin_of(double g) {
  double low = 0.0;
  double high = 10.0;
  for (int i = 0; i < 100; ++i) {
    const double w = 0.5 * (low + high);
    (w * (1.0 + w * w) < g ? low : high) = w;
  }
  return 90.0 - 2.0 * to_degrees(std::atan(low));
}

TEST(LoopStudy, AGainsToleranceIsTheMarginsOfItsEnds) {
  GainLoop loop(0.5, 10.0);
  loop.options.spread.kind = Spread::Kind::corners;
  const LoopStudy corners = loop.study();
  EXPECT_NEAR(corners.nominal.least_phase_margin()->phase_margin_deg, phase_margin_of(0.5), 0.01);
  EXPECT_NEAR(corners.phase_margin_deg.front(), phase_margin_of(0.55), 0.01);
  EXPECT_NEAR(corners.phase_margin_deg.back(), phase_margin_of(0.45), 0.01);
  // L is real at w = 1, where it is -g/2.
  EXPECT_NEAR(corners.gain_margin_db.front(), -to_decibel(0.275), 1e-3);
  EXPECT_NEAR(corners.gain_margin_db.back(), -to_decibel(0.225), 1e-3);
  EXPECT_EQ(corners.unstable, 0u);

  loop.options.spread.kind = Spread::Kind::uniform;
  const LoopStudy even = loop.study();
  ASSERT_EQ(even.phase_margin_deg.size(), 4000u);
  // A larger gain has the smaller margin: 95 of 100 lie below 0.5 (0.9 + 0.2 * 0.95).
  EXPECT_NEAR(kept_by_95(even.phase_margin_deg), phase_margin_of(0.5 * 1.09), 0.1);
  EXPECT_NEAR(to_json(even)["gain_margin_db"]["p5"].get<double>(), -to_decibel(0.5 * 1.09 / 2.0), 0.02);
}

TEST(LoopStudy, CircuitsPastTheirMarginAreUnstable) {
  // Stable to a gain of 2; a third of 1.9 (1 +- 0.1579) lies above it.
  GainLoop loop(1.9, 100.0 * 0.3 / 1.9);
  const LoopStudy study = loop.study();
  EXPECT_NEAR(static_cast<double>(study.unstable) / 4000.0, 1.0 / 3.0, 0.025);
  EXPECT_NEAR(study.phase_margin_deg.front(), phase_margin_of(2.2), 0.05);
  EXPECT_EQ(to_json(study)["unstable"], study.unstable);
  // The same draws whatever the number of threads.
  loop.options.threads = 3;
  EXPECT_EQ(loop.study().phase_margin_deg, study.phase_margin_deg);
}

}  // namespace
}  // namespace bodesmith::tolerance
