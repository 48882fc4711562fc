#include "invert/band_limit.hpp"

#include <cmath>
#include <numbers>

#include "numeric/fourier.hpp"

namespace bodesmith::invert {

std::vector<double> band_limited(const std::vector<double>& u, double step_s, Hertz bandwidth) {
  const std::size_t n = u.size();
  // u and its reflection 2 u_last - u, a straight line taken out so that the whole is periodic.
  const std::size_t whole = 2 * (n - 1);
  const double rise = 2.0 * (u.back() - u.front());
  const auto line = [&](std::size_t i) {
    return u.front() + rise * static_cast<double>(i) / static_cast<double>(whole);
  };
  std::vector<double> long_signal(whole);
  for (std::size_t i = 0; i < whole; ++i)
    long_signal[i] = (i < n ? u[i] : 2.0 * u.back() - u[whole - i]) - line(i);
  auto bins = half_spectrum(long_signal);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const double part = static_cast<double>(k) / (static_cast<double>(whole) * step_s) / bandwidth.value;
    if (part > 0.8) bins[k] *= part < 1.0 ? 0.5 + 0.5 * std::cos(std::numbers::pi * (part - 0.8) / 0.2) : 0.0;
  }
  const std::vector<double> low = from_half_spectrum(bins, whole);
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = (i < whole ? low[i] : low[0]) + line(i);
  return out;
}

}  // namespace bodesmith::invert
