#pragma once

#include "fpaa/plan.hpp"

namespace bodesmith::fpaa {

/// Pole-zero stages one behind the other at one clock (the one given, or the best of the tree), each section on
/// the CAM of the library that offers to make it; their error without holds is minimised. Chips, wires and the
/// note on the hold; errors and headroom are the caller's.
Outcome<Plan> chain_plan(const Sections& sections, const PlanOptions& options, Band band, const Board& board);

}  // namespace bodesmith::fpaa
