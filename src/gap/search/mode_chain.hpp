#pragma once

#include <vector>

#include "gap/search/records.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// Modes of a response one after the other, each where the magnitude alone asks most for one: the phase of several
/// missing modes goes round by more than a turn, and says nothing until all of them are there. Chains of one mode, of two,
/// … as far as they go, each fitted to magnitude and phase in the end; the model of a chain's last member holds them all.
std::vector<std::vector<Ranked>> mode_chains(const SearchSetting& setting, const SearchRecords& records,
                                             const Model& before);

}  // namespace bodesmith::gap
