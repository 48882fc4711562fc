#pragma once

#include <vector>

#include "gap/search/records.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// Whether what a term takes is of use: of what is left without it, and of the gap (kExplained).
bool matters(const SearchSetting& setting, const SearchRecords& records, const Model& without,
             double rms_with);

/// The values of a term alongside the others make it no name (Effect::is_no_name).
bool term_is_no_name(const Model& model, std::size_t term, const Experiments& train);

/// The candidate of the name that holds most: its places and forms share what it holds. Null: none matters. Outcomes are set.
const Ranked* best_of(const SearchSetting& setting, const SearchRecords& records, const Model& without,
                      std::vector<Ranked>& ranking);

/// More than two names, or one of many unknowns: two may do as well.
bool could_be_fewer(const Model& model);

/// Two effects that hide each other: of what each effect promises alongside each of the first names, the best fitted, with both in their
/// models. Greatest evidence first, each two names once.
std::vector<Ranked> best_pairs(const SearchSetting& setting, const SearchRecords& records,
                               const std::vector<Ranked>& first);

}  // namespace bodesmith::gap
