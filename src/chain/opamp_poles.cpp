#include "chain/opamp_poles.hpp"

#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
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

SlowSection slow_section(const Block& section, const PartChange& opamp, double per_hz) {
  const OpampPoles poles = opamp_poles(section, opamp.noise_gain, per_hz);
  const double w = section.get("natural_frequency_hz");
  const double e = w * per_hz;
  // N + s F/(2 pi f) in powers of s over the section's corner, as (1 + b s)(q0 + q1 s + q2 s^2).
  const double c0 = section.get("lowpass_gain");
  const double c1 = section.get("bandpass_gain") + e * opamp.feedthrough[0];
  const double c2 = section.get("highpass_gain") + e * opamp.feedthrough[1];
  const double c3 = e * opamp.feedthrough[2];
  double b = 0.0;
  if (c3 != 0.0) {
    // -b is the smallest root of c0 t^3 + c1 t^2 + c2 t + c3; far below the others, Newton's steps go straight to it.
    constexpr int kSteps = 50;
    double t = -c3 / c2;
    for (int i = 0; i < kSteps; ++i) {
      const double step = (c3 + t * (c2 + t * (c1 + t * c0))) / (c2 + t * (2.0 * c1 + 3.0 * t * c0));
      t -= step;
      if (!(std::abs(step) > 1e-15 * std::abs(t))) break;
    }
    b = -t;
  }
  const double q1 = c1 - b * c0;
  const double q2 = c2 - b * q1;
  const double up = poles.natural_frequency_hz / w;
  SlowSection out{section,
                  b == 0.0 ? make_block("lowpass").set("corner_hz", poles.last->value)
                           : make_block("pole_zero").set("zero_hz", w / b).set("pole_hz", poles.last->value)};
  out.section.set("lowpass_gain", c0)
      .set("bandpass_gain", q1 * up)
      .set("highpass_gain", q2 * up * up)
      .set("natural_frequency_hz", poles.natural_frequency_hz)
      .set("damping_ratio", poles.damping_ratio);
  return out;
}

}  // namespace bodesmith::chain
