#pragma once

#include "gap/search/state.hpp"

namespace bodesmith::gap {

/// A family of many unknowns takes over what another missing effect does beside its simpler relative (asymmetric memory
/// with a constant of its own: symmetric memory and an offset). Each such name is tried against the names it is confused
/// with, each alone or with one more beside it: these take its place where they leave
/// plainly less.
void try_simpler_names(const SearchSetting& setting, State& state);

}  // namespace bodesmith::gap
