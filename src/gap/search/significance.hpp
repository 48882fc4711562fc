#pragma once

#include <vector>

#include "gap/effect.hpp"
#include "gap/search/records.hpp"

namespace bodesmith::gap {

/// Standard deviations of what a term takes of the training records' residuals: improvement_z. Where that is likely and not sure
/// of a known signal (an offset, a drift), the noise's colour is what is in doubt, and likelihood decides: twice what
/// its logarithm gains, less one for the unknown, is the square of what is returned, with the most likely red noise before
/// the term and after it.
double significance_of(const SearchRecords& records, const std::vector<double>& before,
                       const std::vector<double>& after, const Effect& effect);

}  // namespace bodesmith::gap
