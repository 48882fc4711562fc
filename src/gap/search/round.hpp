#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gap/search/records.hpp"
#include "gap/search/shortlist.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// The order of a ranking.
inline bool more_evident(const Ranked& a, const Ranked& b) {
  return a.log_evidence > b.log_evidence;
}

/// One round: what every effect promises where the search stands, the best of it fitted in place, in no
/// particular order and not yet judged. Empty when the search was stopped.
struct FittedRound {
  std::vector<Ranked> ranking;
  std::vector<std::string> not_tried;  ///< effects that promised something when the time was over
};
FittedRound fit_round(const SearchSetting& setting, const SearchRecords& records, const Model& model);

/// The first look of a round alone: what every effect promises, best first.
std::vector<Promising> look_round(const SearchRecords& records, const Model& model);
/// Chosen candidates of such looks, fitted and ranked.
std::vector<Ranked> fit_chosen(const SearchSetting& setting, const SearchRecords& records,
                               const std::vector<Promising>& chosen);

/// Fits candidates in place, with the model's free parameters and all earlier terms: a few steps of each from
/// several starts, then on from the best; those stay where they are that are then far behind the leader. One entry a candidate, empty for those that
/// cannot be run, lost their way or were not begun in time.
std::vector<std::optional<Ranked>> fit_candidates(const SearchSetting& setting, const SearchRecords& records,
                                                  const std::vector<Promising>& candidates);

}  // namespace bodesmith::gap
