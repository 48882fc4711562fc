#pragma once

#include "base/json_fwd.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/layout.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::multiplier_layout {

/// layout.json without its header.
Json to_json(const Layout& layout);
/// Its part "budget".
Json to_json(const Budget& budget);
/// Its part "timing".
Json to_json(const Timing& timing);
/// The transient causes beside the budget at rest: percent of range while they last, s.
Json transient_budget_json(const Timing& timing);

}  // namespace bodesmith::multiplier_layout
