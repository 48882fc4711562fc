#pragma once

#include "gap/search/state.hpp"

namespace bodesmith::gap {

/// The first name decides what the later ones can be. When the search came to no end, or only with many terms, it is
/// begun again with the next effects of the first round. `base`: where it began.
void try_other_ways(const SearchSetting& setting, const State& base, State& state);

/// A round looks at the best few places of an effect, and an earlier name may have taken another one's share: of several
/// names each is tried alone, at all its places, and goes on from there when it comes nearly as far.
void try_each_name_alone(const SearchSetting& setting, const State& base, State& state);

/// Of a few names each is tried against every effect beside the others, where those now stand.
void try_other_partners(const SearchSetting& setting, State& state);

}  // namespace bodesmith::gap
