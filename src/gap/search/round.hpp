#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "gap/search.hpp"
#include "gap/search/records.hpp"
#include "gap/shortlist.hpp"

namespace bodesmith::gap {

/// Effects that a round is confined to; empty: all of them.
using EffectFilter = std::function<bool(const Effect&)>;

/// One round: what every effect promises where the search stands, the best of it fitted in place, in no
/// particular order and not yet judged. Empty when the search was stopped.
std::vector<Ranked> fit_round(const SearchSetting& setting, const SearchRecords& records, const Model& model,
                              const EffectFilter& filter = {});

/// Residuals of the model that a round's candidates are compared with.
struct RoundResiduals {
  std::vector<double> train;
  std::vector<double> holdout;
};

/// Fits one candidate in place, with the model's free parameters and all earlier terms: a few steps from
/// several starts, then on from the best. Nothing when it cannot be run.
std::optional<Ranked> fit_candidate(const SearchSetting& setting, const SearchRecords& records,
                                    const Promising& promising, const RoundResiduals& before);

/// The candidate with what its model leaves of the records. Nothing when the model cannot be run on one of
/// them.
std::optional<Ranked> with_gains(Ranked candidate, const SearchRecords& records,
                                 const RoundResiduals& before);

}  // namespace bodesmith::gap
