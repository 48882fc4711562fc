#pragma once

#include <vector>

#include "chain/chain.hpp"
#include "gap/experiment.hpp"

namespace bodesmith::gap {

/// Start transients are never scored in the search: how many samples to leave out at the beginning of a
/// record. Seven of the base model's slowest time constants, at most two fifths of the record; 3 % of the
/// record at least when its input does not begin at zero, since an effect with memory may then start from
/// anywhere.
std::size_t unscored_samples(const chain::Chain& base, const TimeRecord& record);

}  // namespace bodesmith::gap
