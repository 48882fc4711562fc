#pragma once

#include "gap/search/records.hpp"

namespace bodesmith::gap {

// A record should begin at rest, and its start then tells much (how a resonance rings up). When it began
// otherwise, the residual stands out there, whatever else is missing: that start is no longer scored.

/// Leaves out the starts that stand out under the model; whether there are more of them than before.
bool leave_out_wrong_starts(SearchRecords& records, const Model& model);

/// What stood out at a start may have been the missing effect itself. With a better model the starts are
/// tried again: those that now fit as well as the rest are scored, and the model is refitted.
void score_starts_again(const SearchSetting& setting, SearchRecords& records, Model& model);

}  // namespace bodesmith::gap
