#pragma once

#include <vector>

#include "approximate/approximate.hpp"

namespace bodesmith {

/// Approximations of the terms, with the fewest poles in all for which the product stays within
/// options.max_error_db at all frequencies; the best found up to options.max_order a term when none does.
std::vector<TermApproximation> search_orders(const std::vector<FractionalLeadLag>& terms,
                                             const ApproximationOptions& options);

}  // namespace bodesmith
