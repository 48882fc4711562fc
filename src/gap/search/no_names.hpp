#pragma once

#include <cstddef>
#include <optional>

#include "gap/search/state.hpp"

namespace bodesmith::gap {

/// The first term of a model of time records whose present values make it no name (Effect::is_no_name): beside others, or refitted,
/// it may have become what it was not when it was accepted.
std::optional<std::size_t> term_without_name(const Model& model, const Experiments& records);

/// Takes such terms out, and goes on from what is left: a name that fits is then found, or something is left.
void take_out_no_names(const SearchSetting& setting, State& state);

}  // namespace bodesmith::gap
