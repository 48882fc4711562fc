#include "chain/opamp_poles.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/optimisation/root.hpp"

namespace bodesmith::chain {

std::string_view corner_of(const Block& section) {
  return section.has("damping_ratio") ? "natural_frequency_hz"
         : section.has("pole_hz")     ? "pole_hz"
         : section.has("corner_hz")   ? "corner_hz"
                                      : "";
}

OpampPoles opamp_poles(const Block& section, std::span<const double> noise_gain, double per_hz) {
  OpampPoles out;
  if (corner_of(section).empty()) {
    out.last = Hertz{1.0 / (per_hz * noise_gain[0])};
    return out;
  }
  const bool two = section.has("damping_ratio");
  const double w = section.get(corner_of(section));
  // P + s D/(2 pi f) in powers of s over the section's corner, as (1 + a s)(1 + b1 s + b2 s^2).
  const double e = w * per_hz;
  const double c1 = (two ? 2.0 * section.get("damping_ratio") : 1.0) + e * noise_gain[0];
  const double c2 = (two ? 1.0 : 0.0) + e * noise_gain[1];
  const double c3 = two ? e * noise_gain[2] : 0.0;
  double a = 0.0;
  if (two) {
    const auto cubic = [&](double s) { return 1.0 + s * (c1 + s * (c2 + s * c3)); };
    // Cauchy's bound of the roots.
    a = -1.0 / root_between(cubic, -1.0 - std::max({1.0, c1, c2}) / c3, 0.0);
    // Of three real ones the fastest.
    const double rest = c1 - a;
    const double square = rest * rest - 4.0 * (c2 - a * rest);
    if (square > 0.0) a = std::min(a, c3 / a / (0.5 * (rest + std::sqrt(square))));
    out.last = Hertz{w / a};
  }
  const double b1 = c1 - a;
  const double b2 = two ? c3 / a : c2;
  out.natural_frequency_hz = w / std::sqrt(b2);
  out.damping_ratio = 0.5 * b1 / std::sqrt(b2);
  return out;
}

}  // namespace bodesmith::chain
