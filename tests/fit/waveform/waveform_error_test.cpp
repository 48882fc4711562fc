#include "fit/waveform/waveform_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "fit/cascade/cascade_fit.hpp"
#include "fit/paper_disturbance.hpp"

namespace bodesmith {
namespace {

Cascade magnitude_only() {
  BodePoints points;
  const Disturbance d = both_driven();
  for (size_t i = 0; i < d.rate.frequency.size(); ++i) {
    points.points.push_back({d.rate.frequency[i], d.rate.descending[i], std::nullopt, 1.0, 0});
  }
  return fit_cascade(points).cascade;
}

TEST(WaveformError, MagnitudeAloneMakesTheWaveformWorse) {
  const Disturbance d = both_driven();
  const Cascade cascade = magnitude_only();
  const auto through =
      waveform_error([&](RadPerSecond w) { return cascade.response(w); }, d, d.rate.frequency);
  EXPECT_NEAR(through.points.back().rms_percent, 1.40, 0.01);
  const auto none = waveform_error([](RadPerSecond) { return 1.0; }, d, d.rate.frequency);
  EXPECT_NEAR(none.points.back().rms_percent, 0.85, 0.01);
  EXPECT_GT(through.worst_percent, none.worst_percent);
}

TEST(WaveformError, ConstantGainInClosedForm) {
  const Disturbance d = both_driven();
  // rms of the disturbance itself: Simpson on each branch is not exact for a square of cubics, so fine steps.
  double square = 0.0;
  double peak = 0.0;
  const int steps = 200000;
  for (int i = 0; i < steps; ++i) {
    const double x = (i + 0.5) / steps;
    square += 0.5 *
              (std::pow(d.value(Disturbance::Branch::ascending, x), 2) +
               std::pow(d.value(Disturbance::Branch::descending, x), 2)) /
              steps;
    for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending})
      peak = std::max(peak, std::abs(d.value(branch, x)));
  }
  const auto got = waveform_error([](RadPerSecond) { return 1.1; }, d, {Hertz{60.0}});
  EXPECT_NEAR(got.points[0].rms_percent, 100.0 * 0.06 * std::sqrt(square), 1e-6);
  EXPECT_NEAR(got.points[0].peak_percent, 100.0 * 0.06 * peak, 1e-4);
  EXPECT_NEAR(waveform_error([](RadPerSecond) { return 1.1; }, d, {Hertz{20.0}}).worst_percent, 0.0, 1e-12);
}

// An independent time simulation: one pole-zero section, exact step by step for piecewise linear input, run
// to its periodic steady state.
TEST(WaveformError, AgreesWithATimeSimulation) {
  const Disturbance d = both_driven();
  struct Case {
    DrivenPath path;
    double zero;
  };
  // The last one's corners lie above the first thousand harmonics: it is late by microseconds at each corner of the triangle.
  for (const Case& one : {Case{DrivenPath::whole, 300.0}, Case{DrivenPath::descending, 300.0},
                          Case{DrivenPath::descending, 2e5}}) {
    const DrivenPath path = one.path;
    const double zero = one.zero, pole = 1.5 * zero, gain = 1.2;
    const auto g = [&](RadPerSecond w) {
      return gain * std::complex<double>(zero, w.value) / std::complex<double>(pole, w.value);
    };
    const double f = 37.0;
    const int steps = 20000;
    const double h = 1.0 / (f * steps);
    const TriangleSeries u = triangle_series(d, path, 8);
    // y = gain (u + (zero - pole) v), v' = u - pole v.
    double v = 0.0;
    double square = 0.0, peak = 0.0;
    const double decay = std::exp(-pole * h);
    const double ramp = (1.0 - (1.0 - decay) / (pole * h)) / pole;
    const double hold = (1.0 - decay) / pole - ramp;
    for (int period = 0; period < 8; ++period) {
      for (int i = 0; i < steps; ++i) {
        const double phase = static_cast<double>(i) / steps;
        const double now = u.value(phase);
        const double next = u.value(i + 1 == steps ? 0.0 : (i + 1.0) / steps);
        const bool rising = phase < 0.5;
        if (period == 7 && !(path == DrivenPath::descending && rising)) {
          const double wanted = d.rate_gain(Disturbance::Branch::descending, Hertz{f}) * now;
          const double e = gain * (now + (zero - pole) * v) - wanted;
          square += e * e / steps;
          peak = std::max(peak, std::abs(e));
        }
        v = decay * v + hold * now + ramp * next;
      }
    }
    const auto got = waveform_error(g, d, {Hertz{f}}, {.path = path});
    EXPECT_NEAR(got.points[0].rms_percent / (100.0 * std::sqrt(square)), 1.0, 2e-4) << static_cast<int>(path);
    if (path == DrivenPath::descending) {
      EXPECT_NEAR(got.points[0].peak_percent / (100.0 * peak), 1.0, 0.05);
    }
  }
}

TEST(WaveformError, RefusesNothingToJudge) {
  EXPECT_THROW(waveform_error([](RadPerSecond) { return 1.0; }, both_driven(), {}), InputError);
}

}  // namespace
}  // namespace bodesmith
