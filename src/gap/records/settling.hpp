#pragma once

#include <cstddef>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::gap {

/// The input does not begin at zero (but for a hundredth of its range): what it did before is not in the record.
bool begins_under_bias(const TimeRecord& record);

/// How long the start of a record is, in samples, when the record may have begun in another state than rest:
/// seven of the base model's slowest time constants, at most two fifths of the record; 3 % of the record at
/// least when its input does not begin at zero, since an effect with memory may then start from anywhere.
std::size_t start_samples(const chain::Chain& base, const TimeRecord& record);

}  // namespace bodesmith::gap
