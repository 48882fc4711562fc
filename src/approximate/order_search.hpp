#pragma once

#include <vector>

#include "approximate/term.hpp"

namespace bodesmith {

/// Approximations of the terms, with the fewest poles in all for which the product stays within max_error_db at all
/// frequencies; the best found up to options.max_order a term when none does. Refused when the method makes no order up
/// to max_order for one of the terms.
Outcome<std::vector<TermApproximation>> search_orders(const std::vector<FractionalLeadLag>& terms,
                                                      const ApproximationOptions& options,
                                                      double max_error_db);

}  // namespace bodesmith
