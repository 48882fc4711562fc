#include "tracking/slope_meter.hpp"

#include <cmath>

namespace bodesmith::tracking {
namespace {

/// A first-order lag over a repeating input that is constant from sample to sample, in steady state; the values at
/// the beginning of each interval.
std::vector<double> lagged(const std::vector<double>& input, double step_s, double time_constant_s) {
  if (!(time_constant_s > 0.0)) return input;
  const double keep = std::exp(-step_s / time_constant_s);
  const auto round = [&](double state, std::vector<double>* out) {
    for (std::size_t i = 0; i < input.size(); ++i) {
      if (out != nullptr) (*out)[i] = state;
      state = keep * state + (1.0 - keep) * input[i];
    }
    return state;
  };
  const double all = std::exp(-step_s * static_cast<double>(input.size()) / time_constant_s);
  std::vector<double> out(input.size());
  round(round(0.0, nullptr) / (1.0 - all), &out);
  return out;
}

}  // namespace

MeasuredSlope measure_slope(const SlopeGain& gain, const Reference& reference, Hertz operating,
                            std::size_t samples) {
  const double step =
      static_cast<double>(reference.periods()) / (operating.value * static_cast<double>(samples));
  const std::vector<double> r = reference.samples(samples);
  std::vector<double> rate(samples);
  for (std::size_t i = 0; i < samples; ++i) rate[i] = (r[(i + 1) % samples] - r[i]) / step;
  MeasuredSlope out;
  out.slope = lagged(rate, step, gain.differentiator_s);
  std::vector<double> size(samples);
  for (std::size_t i = 0; i < samples; ++i)
    size[i] = 0.5 * (std::abs(out.slope[i]) + std::abs(out.slope[(i + 1) % samples]));
  out.smoothed = lagged(size, step, gain.smoothing_s);
  if (!(gain.smoothing_s > 0.0))
    for (std::size_t i = 0; i < samples; ++i) out.smoothed[i] = std::abs(out.slope[i]);
  for (const double m : out.smoothed) out.frequency_hz.push_back(0.5 * m / reference.alpha());
  return out;
}

}  // namespace bodesmith::tracking
