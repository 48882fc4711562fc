#include "tracking/paths.hpp"

#include <cmath>

namespace bodesmith::tracking {

Sections lowpass_path(Hertz corner) {
  const double w = corner.rad_s().value;
  return Sections{1.0, {Section{w, {}, {-w}}}, std::nullopt};
}

Sections resonance_path(Hertz natural_frequency, double damping_ratio) {
  const double w = natural_frequency.rad_s().value;
  Section s;
  s.gain = w * w;
  if (damping_ratio < 1.0) {
    const double im = w * std::sqrt(1.0 - damping_ratio * damping_ratio);
    s.poles = {{-damping_ratio * w, im}, {-damping_ratio * w, -im}};
  } else {
    const double root = std::sqrt(damping_ratio * damping_ratio - 1.0);
    s.poles = {-w * (damping_ratio - root), -w * (damping_ratio + root)};
  }
  return Sections{1.0, {s}, std::nullopt};
}

Sections in_series(const std::vector<Sections>& paths) {
  Sections out;
  for (const Sections& path : paths) {
    out.gain *= path.gain;
    out.sections.insert(out.sections.end(), path.sections.begin(), path.sections.end());
  }
  return out;
}

}  // namespace bodesmith::tracking
