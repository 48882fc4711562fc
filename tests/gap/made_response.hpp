#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "gap/made_model.hpp"
#include "numeric/random.hpp"
#include "signal/bode_points.hpp"

namespace made {

using Complex = std::complex<double>;
using Response = std::function<Complex(double hz)>;

inline Complex mode(double hz, double natural_hz, double damping) {
  const double r = hz / natural_hz;
  return 1.0 / Complex(1.0 - r * r, 2.0 * damping * r);
}
inline Complex lag(double hz, double corner_hz) {
  return 1.0 / Complex(1.0, hz / corner_hz);
}

/// A response over log frequency with relative noise `noise(hz)` in each part.
inline bodesmith::FrequencyRecord measured(const Response& h, double from_hz, double to_hz, int count,
                                           const std::function<double(double)>& noise, std::uint64_t seed) {
  bodesmith::Random random(seed);
  bodesmith::FrequencyRecord out;
  out.file = "made.csv";
  for (int i = 0; i < count; ++i) {
    const double hz = from_hz * std::pow(to_hz / from_hz, i / (count - 1.0));
    const double re = noise(hz) * random.normal();
    out.frequency.push_back(bodesmith::Hertz{hz});
    out.response.push_back(h(hz) * Complex(1.0 + re, noise(hz) * random.normal()));
  }
  return out;
}

/// A gain that may be refitted.
inline bodesmith::chain::Chain free_gain(double gain) {
  return bodesmith::model_of(
      "[[block]]\ntype = \"gain\"\noffset = 0.0\nfree = [\"gain\"]\ngain = " + std::to_string(gain) + "\n");
}

}  // namespace made
