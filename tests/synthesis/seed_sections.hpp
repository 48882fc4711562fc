#pragma once

#include "lti/sections.hpp"

namespace bodesmith {

/// First seed, eq. 21 to 24, with the pole 625.1 of eq. 24 read as 652.1 (so that G4(0) = 1).
inline Sections seed_sections() {
  const auto section = [](double gain, double z1, double z2, double p1, double p2) {
    Section out;
    out.gain = gain;
    out.zeros = {{-z1, 0.0}, {-z2, 0.0}};
    out.poles = {{-p1, 0.0}, {-p2, 0.0}};
    return out;
  };
  Sections out;
  out.sections = {section(0.918, 48.79, 14.8, 47.49, 13.99), section(1.885, 107.6, 63.68, 126.4, 102.2),
                  section(0.318, 380.2, 221.6, 214.9, 124.8), section(2.628, 400.0, 365.6, 652.1, 589.4)};
  return out;
}

}  // namespace bodesmith
