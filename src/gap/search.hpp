#pragma once

#include "gap/records/experiment.hpp"
#include "gap/search_options.hpp"
#include "gap/search_result.hpp"

namespace bodesmith::gap {

/// The search described in docs/gap.md: shortlist, fit in place, accept or refuse, look again. It sees the
/// training records alone.
SearchResult search(const chain::Chain& base, const Experiments& train, const SearchOptions& options);

}  // namespace bodesmith::gap
