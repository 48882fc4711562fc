#pragma once

#include "gap/search/records.hpp"

namespace bodesmith::gap {

// A record should begin at rest, and its start then tells much (how a resonance rings up). When it began
// otherwise, the residual stands out there, whatever else is missing: that start is no longer scored.

/// Records with the starts left out that stand out under the model.
struct WrongStarts {
  SearchRecords records;
  bool found = false;  ///< more of them than before
};
WrongStarts leave_out_wrong_starts(const SearchSetting& setting, SearchRecords records, const Model& model);

/// What stood out at a start may have been the missing effect itself. With a better model the starts are
/// tried again: those that now fit as well as the rest are scored.
struct StartsTried {
  SearchRecords records;
  Model model;
};
StartsTried score_starts_again(const SearchSetting& setting, SearchRecords records, Model model);

}  // namespace bodesmith::gap
