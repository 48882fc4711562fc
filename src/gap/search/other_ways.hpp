#pragma once

#include "gap/search/state.hpp"

namespace bodesmith::gap {

/// The first name decides what the later ones can be. When the search came to no end, or only with many terms, it is
/// begun again with the next effects of the first round. `base`: where it began.
void try_other_ways(const SearchSetting& setting, const State& base, State& state);

}  // namespace bodesmith::gap
