#pragma once

#include <string>
#include <vector>

#include "base/units.hpp"
#include "fpaa/cams/filter_biquad.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// What one filter CAM has to do: a piece of a section with one real pole or a complex pair, gain left out.
struct FilterPart {
  enum class Kind {
    pole_zero,  ///< (1 + s/zero) / (1 + s/pole)
    low_pass,   ///< 1 / (1 + s/pole)
    high_pass,  ///< s / (1 + s/pole), s in rad/s
    biquad,     ///< complex poles: 1, s/(Q w0) or (s/w0)^2 over 1 + s/(Q w0) + (s/w0)^2
  };
  Kind kind = Kind::pole_zero;
  int section = 0;   ///< index into the sections, from 0
  std::string name;  ///< "Section1", or "Section1a" and "Section1b" when a section takes two
  RadPerSecond zero;
  RadPerSecond pole;
  BiquadTarget biquad;  ///< with gain 1

  std::complex<double> response(RadPerSecond w) const;
};

/// Sections in pieces of one real pole, and the gain that stays over:
/// H(s) = sign * exp(log_gain) * prod of the parts.
struct FilterParts {
  std::vector<FilterPart> parts;
  double log_gain = 0.0;
  bool negative = false;
};

/// Complex poles without finite zeros, or with zeros at s = 0 only, become a FilterBiquad; a section of two
/// real poles becomes two parts, each zero with the pole that is nearest in ratio (the pairing whose widest
/// pair is narrowest). Throws DesignError for what the bilinear CAM cannot do, naming the section and what
/// would make it work: other complex roots, a zero in the right half plane.
FilterParts split_into_parts(const Sections& sections);

}  // namespace bodesmith::fpaa
