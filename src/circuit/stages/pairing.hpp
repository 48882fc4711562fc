#pragma once

#include <vector>

#include "lti/sections.hpp"

namespace bodesmith::circuit {

/// Sections for a cascade of stages: the real poles and zeros of all sections whose roots are real are
/// pooled, sorted and paired so that the greatest |ln(zero/pole)| of a pair is least (the least span a stage;
/// exact, by dynamic programming), one pole a stage. Sections with complex roots stay whole. Every stage's
/// gain is 1 up to `leading_gain`, which takes all of it: H(s) = leading_gain prod prod(s - z)/prod(s - p).
struct Split {
  double leading_gain = 1.0;
  std::vector<Section> stages;  ///< gain 1
};
Split split_into_stages(const Sections& sections);
/// As split_into_stages(), but real roots are kept in pairs too: stages of two poles (one is left alone when
/// their number is odd), for realisations that make two poles.
Split split_into_two_pole_stages(const Sections& sections);

}  // namespace bodesmith::circuit
