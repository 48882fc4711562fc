#pragma once

#include "gap/search/state.hpp"

namespace bodesmith::gap {

/// Two names that come together where one after the other came to no end, or to one that two could do without: a first name
/// takes over what it can of the second one's share, and what is then left is neither's. `base`: where the search began.
void try_other_ways(const SearchSetting& setting, const State& base, State& state);

/// Of a few names each is tried against every effect beside the others, where those now stand.
void try_other_partners(const SearchSetting& setting, State& state);

}  // namespace bodesmith::gap
