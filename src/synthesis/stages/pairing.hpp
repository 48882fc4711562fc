#pragma once

#include <vector>

#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::synthesis {

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

/// Stages with their share of the gain, in the order of the signal.
struct Ordered {
  std::vector<Section> stages;   ///< gains above 0; their product is |gain|
  double highest_node_db = 0.0;  ///< over the band, at any stage's output
  double lowest_node_db = 0.0;
};

/// Spreads |gain| over the stages: each is levelled (its highest and lowest magnitude over the band equally
/// far from 0 dB) and takes an equal share of what is left. Orders them so that the greatest |dB| at any node
/// between stages is least: exactly, over all subsets, up to 14 stages; nearest next stage above that.
Ordered order_stages(const std::vector<Section>& stages, double gain, Band band);

}  // namespace bodesmith::synthesis
