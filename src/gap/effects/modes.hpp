#pragma once

#include <cstddef>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "gap/scene.hpp"

namespace bodesmith::gap {

/// A mode that is damped more has no peak: it is two lags, which have names of their own.
constexpr double kMostDamping = std::numbers::sqrt2 / 2.0;

/// Where a mode may be missing: at peaks of the residual; in a response at up to a hundred of its points, as runs are cheap there and a
/// sharp mode is only seen from near by; and at these multiples of the band.
inline std::vector<double> mode_frequencies_hz(const Scene& scene,
                                               std::initializer_list<double> of_band = {}) {
  auto found = scene.residual_peaks_hz;
  const std::size_t apart = 1 + scene.frequency.size() / 100;
  for (std::size_t i = 0; i < scene.frequency.size(); i += apart) found.push_back(scene.frequency[i].value);
  for (double factor : of_band) found.push_back(factor * scene.band_hz);
  std::erase_if(found, [&](double hz) { return !(hz > 0.0) || hz > 0.95 * scene.top_hz; });
  return found;
}

}  // namespace bodesmith::gap
