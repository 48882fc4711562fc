#pragma once

#include <cstddef>
#include <vector>

#include "fpaa/candidates.hpp"

namespace bodesmith::fpaa {

/// Beam search in the sense of least squares, the coarsest branch first: those not yet chosen are taken as
/// continuous (linearised, bound to their nominal corner by `corner_weight`), the common gain as free. What a
/// partial choice costs is then what no choice of the rest could repair. At most `width` partial choices are
/// kept; the result is the last of them, cheapest first.
std::vector<Choice> beam_search(const CandidateLists& lists, double corner_weight, std::size_t width);

}  // namespace bodesmith::fpaa
