#pragma once

#include "gap/search/records.hpp"

namespace bodesmith::gap {

// A record should begin at rest, and its start then tells much (how a resonance rings up). When it began
// otherwise, the residual stands out there, whatever else is missing: that start is no longer scored, or,
// when it would take too much of the record, what unknown initial states explain is taken out.

/// Records with the starts left out that stand out under the model, and free responses as the model has them
/// now.
struct WrongStarts {
  SearchRecords records;
  bool found = false;  ///< more of them than before
};
WrongStarts leave_out_wrong_starts(const SearchSetting& setting, SearchRecords records, const Model& model);

/// The same starts left out, with free responses as the model has them now.
SearchRecords renew_free_responses(const SearchSetting& setting, SearchRecords records, const Model& model);

/// The same starts left out whole: free responses of a model that is off are of no use.
SearchRecords leave_out_whole_starts(SearchRecords records);

/// What stood out at a start may have been the missing effect itself. With a better model the starts are
/// tried again: those that now fit as well as the rest are scored.
struct StartsTried {
  SearchRecords records;
  Model model;
};
StartsTried score_starts_again(const SearchSetting& setting, SearchRecords records, Model model);

}  // namespace bodesmith::gap
