#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

/// An amplitude-modulated triangle in [0, 1], 400 samples a cycle, whose first cycle has the full stroke.
inline std::vector<double> modulated_triangle(std::size_t n) {
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double cycle = static_cast<double>(i) / 400.0;
    const double phase = cycle - std::floor(cycle);
    const double triangle = phase < 0.5 ? 4.0 * phase - 1.0 : 3.0 - 4.0 * phase;
    const double envelope = i < 400 ? 1.0 : 0.55 + 0.45 * std::cos(0.86 * cycle);
    out[i] = 0.5 + 0.5 * envelope * triangle;
  }
  return out;
}

/// Relay weights of a plane of so many levels: strongest next to the diagonal.
inline std::vector<double> relay_weights(std::size_t levels) {
  std::vector<double> w;
  for (std::size_t i = 0; i < levels; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      w.push_back(std::exp(-1e-3 * static_cast<double>((i - j) * (i - j))) / 1e4);
  return w;
}
