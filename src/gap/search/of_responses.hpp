#pragma once

#include "gap/search_options.hpp"

namespace bodesmith::gap {

/// The options as a search of frequency responses takes them.
SearchOptions for_responses(SearchOptions options);

}  // namespace bodesmith::gap
