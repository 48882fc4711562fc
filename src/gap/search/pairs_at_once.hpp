#pragma once

#include <utility>
#include <vector>

#include "gap/search/records.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// The few pairs of names that together leave least, best first, whatever each of them leaves alone: beside the first names of a
/// round a look says what each second one would leave, and the best of all these are fitted. A wrong name that takes the most
/// of both shares is then one first name among others.
std::vector<std::pair<Step, Step>> pairs_at_once(const SearchSetting& setting, const SearchRecords& records,
                                                 const Model& before, const std::vector<Ranked>& ranking);

}  // namespace bodesmith::gap
