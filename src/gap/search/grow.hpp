#pragma once

#include "gap/search/state.hpp"

namespace bodesmith::gap {

/// Round after round until nothing more earns its place; then the signs of what is left.
void grow(const SearchSetting& setting, State& state);

}  // namespace bodesmith::gap
