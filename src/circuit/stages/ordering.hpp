#pragma once

#include <vector>

#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::circuit {

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

}  // namespace bodesmith::circuit
