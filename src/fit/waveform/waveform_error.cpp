#include "fit/waveform/waveform_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "base/error.hpp"
#include "numeric/fourier.hpp"

namespace bodesmith {
namespace {

/// 1/2 integral_0^1 (a1 x + a2 x^2 + a3 x^3) e^(-j pi k x) dx: the rising half's share of U_k.
Complex half_coefficient(const std::array<double, 3>& a, std::size_t k) {
  if (k == 0) return 0.5 * (a[0] / 2.0 + a[1] / 3.0 + a[2] / 4.0);
  const Complex j_theta(0.0, std::numbers::pi * static_cast<double>(k));
  const double end = k % 2 == 0 ? 1.0 : -1.0;  // e^(-j pi k)
  Complex moment = (1.0 - end) / j_theta;
  Complex sum = 0.0;
  for (std::size_t m = 1; m <= 3; ++m) {
    moment = (static_cast<double>(m) * moment - end) / j_theta;  // by parts
    sum += a[m - 1] * moment;
  }
  return 0.5 * sum;
}

/// Re sum_k part_k e^(2 pi j k (m + 1/2)/samples) for every m: samples stand in the middle of equal intervals, none on a
/// corner.
std::vector<double> period_of(const std::vector<Complex>& part, std::size_t samples) {
  std::vector<Complex> bins(samples / 2 + 1);
  for (std::size_t k = 0; k < part.size(); ++k) {
    const double half_step = std::numbers::pi * static_cast<double>(k) / static_cast<double>(samples);
    bins[k] = part[k] * std::polar(k == 0 ? 1.0 : 0.5, half_step) * static_cast<double>(samples);
  }
  return from_half_spectrum(bins, samples);
}

/// Harmonics of (G - G_inf) u at one operating frequency; G_inf = `beyond`.
std::vector<Complex> filtered_harmonics(const FrequencyResponse& g, const TriangleSeries& input, Hertz f,
                                        double beyond) {
  // Each of the first harmonics; further up straight lines over log f between twelve points an octave.
  constexpr std::size_t kEach = 400;
  const double ratio = std::exp2(1.0 / 12.0);
  const auto at = [&](double k) { return g(Hertz{f.value * k}.rad_s()); };
  double to = kEach;
  Complex below = 0.0, above = at(to);
  std::vector<Complex> part(input.coefficient.size());
  // A real G has a real limit at 0 Hz; a millionth of the fundamental stands for it.
  part[0] = (at(1e-6).real() - beyond) * input.coefficient[0];
  for (std::size_t k = 1; k < part.size(); ++k) {
    const auto order = static_cast<double>(k);
    if (k > kEach && order > to) {
      below = above;
      above = at(to *= ratio);
    }
    const Complex response = k <= kEach ? at(order) : above + (below - above) * std::log2(to / order) * 12.0;
    part[k] = (response - beyond) * input.coefficient[k] * 2.0;
  }
  return part;
}

/// e = sum over harmonics of (G - G_inf) U + G_inf u(t) - target(t): the harmonics left out see G_inf.
WaveformErrorPoint error_at_frequency(const FrequencyResponse& g, const Disturbance& disturbance,
                                      const TriangleSeries& input, Hertz f) {
  const std::size_t harmonics = input.coefficient.size() - 1;
  const std::size_t samples = 4 * harmonics;
  const double beyond = g(Hertz{f.value * static_cast<double>(harmonics) * 1e3}.rad_s()).real();
  const std::vector<double> filtered = period_of(filtered_harmonics(g, input, f, beyond), samples);
  const double gain_up = disturbance.rate_gain(Disturbance::Branch::ascending, f);
  const double gain_down = disturbance.rate_gain(Disturbance::Branch::descending, f);
  double square = 0.0;
  double peak = 0.0;
  for (std::size_t m = 0; m < samples; ++m) {
    const double phase = (static_cast<double>(m) + 0.5) / static_cast<double>(samples);
    const bool rising = phase < 0.5;
    if ((input.path == DrivenPath::ascending && !rising) || (input.path == DrivenPath::descending && rising))
      continue;
    const double direct = (beyond - (rising ? gain_up : gain_down)) * input.value(phase);
    const double e = direct + filtered[m];
    square += e * e;
    peak = std::max(peak, std::abs(e));
  }
  return {f, 100.0 * std::sqrt(square / static_cast<double>(samples)), 100.0 * peak};
}

}  // namespace

FrequencyResponse remembered(FrequencyResponse response) {
  struct Known {
    std::mutex guard;
    std::unordered_map<double, Complex> at;
  };
  return [response = std::move(response), known = std::make_shared<Known>()](RadPerSecond w) {
    {
      const std::lock_guard lock(known->guard);
      if (const auto at = known->at.find(w.value); at != known->at.end()) return at->second;
    }
    const Complex h = response(w);
    const std::lock_guard lock(known->guard);
    return known->at.emplace(w.value, h).first->second;
  };
}

double TriangleSeries::value(double phase) const {
  using Branch = Disturbance::Branch;
  const bool rising = phase < 0.5;
  const double x = rising ? 2.0 * phase : 2.0 - 2.0 * phase;
  if (path == DrivenPath::ascending) return disturbance.value(Branch::ascending, x);
  if (path == DrivenPath::descending) return disturbance.value(Branch::descending, x);
  return disturbance.value(rising ? Branch::ascending : Branch::descending, x);
}

TriangleSeries triangle_series(const Disturbance& disturbance, DrivenPath path, std::size_t harmonics) {
  TriangleSeries out;
  out.disturbance = disturbance;
  out.path = path;
  const auto& up = path == DrivenPath::descending ? disturbance.descending : disturbance.ascending;
  const auto& down = path == DrivenPath::ascending ? disturbance.ascending : disturbance.descending;
  for (std::size_t k = 0; k <= harmonics; ++k) {
    // The falling half is the rising one reversed in time.
    out.coefficient.push_back(half_coefficient(up, k) + std::conj(half_coefficient(down, k)));
  }
  return out;
}

std::string_view to_string(DrivenPath path) {
  constexpr std::array kWords = {"whole", "ascending", "descending"};
  return kWords.at(static_cast<std::size_t>(path));
}

std::vector<Hertz> operating_frequencies(const Disturbance& disturbance) {
  return disturbance.rate.frequency;
}

WaveformError waveform_error(const FrequencyResponse& g, const Disturbance& disturbance,
                             const std::vector<Hertz>& operating, const WaveformErrorOptions& options) {
  if (operating.empty()) throw InputError("the waveform error needs at least one operating frequency");
  if (options.harmonics < 8) throw InputError("the waveform error needs at least 8 harmonics");
  const auto harmonics = static_cast<std::size_t>(options.harmonics);
  const TriangleSeries input = triangle_series(disturbance, options.path, harmonics);
  WaveformError out;
  double mean_square = 0.0;
  for (const Hertz f : operating) {
    if (!(f.value > 0.0)) throw InputError("an operating frequency is not above 0");
    const WaveformErrorPoint point = error_at_frequency(g, disturbance, input, f);
    mean_square += point.rms_percent * point.rms_percent / static_cast<double>(operating.size());
    out.worst_percent = std::max(out.worst_percent, point.rms_percent);
    out.points.push_back(point);
  }
  out.rms_percent = std::sqrt(mean_square);
  return out;
}

}  // namespace bodesmith
