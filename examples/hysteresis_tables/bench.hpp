#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "hysteresis/model_type.hpp"
#include "identify/stage_fit.hpp"
#include "invert/compensation.hpp"
#include "virtual_stage.hpp"

/// What the five programs share: waveforms, driving the stage, and the error of eq. 8 of "Modeling and Control of Piezoelectric Hysteresis".
namespace bench {

using namespace bodesmith;
using namespace bodesmith::hysteresis;
using namespace bodesmith::identify;

inline constexpr double kPi = std::numbers::pi;

/// f(t) sampled n times a period for a number of periods.
inline std::vector<double> wave(int n, double periods, const std::function<double(double cycle)>& f) {
  std::vector<double> out;
  for (int i = 0; i <= static_cast<int>(n * periods); ++i) out.push_back(f(static_cast<double>(i) / n));
  return out;
}

inline double triangle(double cycle) {
  const double p = cycle - std::floor(cycle);
  return p < 0.5 ? 2.0 * p : 2.0 - 2.0 * p;  // 0 … 1
}

/// The stage's answer, started at rest under the first drive.
inline TimeRecord measure(const VirtualStageSettings& settings, const std::vector<double>& drive,
                          double step_s) {
  VirtualStage stage(settings);
  TimeRecord out;
  out.file = "virtual stage";
  out.step_s = step_s;
  out.u = drive;
  out.y.push_back(stage.reset(drive[0]));
  for (std::size_t i = 1; i < drive.size(); ++i) out.y.push_back(stage.step(drive[i], step_s));
  return out;
}

struct TrackingError {
  double rms, max, rms_percent, max_percent;
};

/// Over the samples from `first` on; the percentages are of the reference signal's range there.
inline TrackingError tracking_error(const std::vector<double>& got, const std::vector<double>& reference,
                                    std::size_t first) {
  double squares = 0.0, largest = 0.0, low = reference[first], high = reference[first];
  for (std::size_t i = first; i < reference.size(); ++i) {
    const double e = got[i] - reference[i];
    squares += e * e;
    largest = std::max(largest, std::abs(e));
    low = std::min(low, reference[i]);
    high = std::max(high, reference[i]);
  }
  const double rms = std::sqrt(squares / static_cast<double>(reference.size() - first));
  return {rms, largest, 100.0 * rms / (high - low), 100.0 * largest / (high - low)};
}

/// The same after the delay that makes it least (linear between samples), as papers do that "eliminate the
/// phase lag".
inline TrackingError error_without_delay(const std::vector<double>& got, const std::vector<double>& reference,
                                         std::size_t first, double most_samples, double* found = nullptr) {
  const auto at = [&](double delay) {
    std::vector<double> shifted = later_by(got, -delay);
    const auto cut = static_cast<std::size_t>(std::ceil(most_samples)) + 1;
    shifted.resize(shifted.size() - cut);
    std::vector<double> r(reference.begin(), reference.end() - static_cast<std::ptrdiff_t>(cut));
    return tracking_error(shifted, r, first);
  };
  double best = 0.0;
  for (int i = 1; i <= 80; ++i)
    if (at(most_samples * i / 80.0).rms < at(best).rms) best = most_samples * i / 80.0;
  if (found != nullptr) *found = best;
  return at(best);
}

}  // namespace bench
