#include "fit/waveform_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "fit/triangle_series.hpp"

namespace bodesmith {

std::string_view to_string(DrivenPath path) {
  switch (path) {
    case DrivenPath::whole:
      return "whole";
    case DrivenPath::ascending:
      return "ascending";
    case DrivenPath::descending:
      return "descending";
  }
  return "";
}

std::vector<Hertz> operating_frequencies(const Disturbance& disturbance) {
  return disturbance.rate.frequency;
}

WaveformError waveform_error(const FrequencyResponse& g, const Disturbance& disturbance,
                             const std::vector<Hertz>& operating, const WaveformErrorOptions& options) {
  if (operating.empty()) throw InputError("the waveform error needs at least one operating frequency");
  if (options.harmonics < 8) throw InputError("the waveform error needs at least 8 harmonics");
  const auto harmonics = static_cast<size_t>(options.harmonics);
  const size_t samples = 4 * harmonics;
  const TriangleSeries input = triangle_series(disturbance, options.path, harmonics);
  // Samples in the middle of equal intervals: none stands on a corner.
  std::vector<double> cosine(2 * samples);
  std::vector<double> sine(2 * samples);
  for (size_t i = 0; i < 2 * samples; ++i) {
    const double angle = std::numbers::pi * static_cast<double>(i) / static_cast<double>(samples);
    cosine[i] = std::cos(angle);
    sine[i] = std::sin(angle);
  }

  WaveformError out;
  double mean_square = 0.0;
  for (const Hertz f : operating) {
    if (!(f.value > 0.0)) throw InputError("an operating frequency is not above 0");
    // e = sum over harmonics of (G - G_inf) U + G_inf u(t) - wanted(t): the harmonics left out see G_inf.
    const double beyond = g(Hertz{f.value * options.harmonics * 1e3}.rad_s()).real();
    std::vector<std::complex<double>> part(harmonics + 1);
    for (size_t k = 0; k <= harmonics; ++k) {
      // A real G has a real limit at 0 Hz; a millionth of the fundamental stands for it.
      const double at = k == 0 ? f.value * 1e-6 : f.value * static_cast<double>(k);
      std::complex<double> response = g(Hertz{at}.rad_s());
      if (k == 0) response = response.real();
      part[k] = (response - beyond) * input.coefficient[k] * (k == 0 ? 1.0 : 2.0);
    }
    const double gain_up = disturbance.rate_gain(Disturbance::Branch::ascending, f);
    const double gain_down = disturbance.rate_gain(Disturbance::Branch::descending, f);
    double square = 0.0;
    double peak = 0.0;
    for (size_t m = 0; m < samples; ++m) {
      const double phase = (static_cast<double>(m) + 0.5) / static_cast<double>(samples);
      const bool rising = phase < 0.5;
      if ((options.path == DrivenPath::ascending && !rising) ||
          (options.path == DrivenPath::descending && rising))
        continue;
      double e = (beyond - (rising ? gain_up : gain_down)) * input.value(phase);
      const size_t turn = 2 * m + 1;
      size_t index = 0;
      for (size_t k = 0; k <= harmonics; ++k) {
        e += part[k].real() * cosine[index] - part[k].imag() * sine[index];
        index += turn;
        if (index >= 2 * samples) index -= 2 * samples;
      }
      square += e * e;
      peak = std::max(peak, std::abs(e));
    }
    WaveformErrorPoint point;
    point.frequency = f;
    point.rms_percent = 100.0 * std::sqrt(square / static_cast<double>(samples));
    point.peak_percent = 100.0 * peak;
    mean_square += point.rms_percent * point.rms_percent / static_cast<double>(operating.size());
    out.worst_percent = std::max(out.worst_percent, point.rms_percent);
    out.points.push_back(point);
  }
  out.rms_percent = std::sqrt(mean_square);
  return out;
}

}  // namespace bodesmith
