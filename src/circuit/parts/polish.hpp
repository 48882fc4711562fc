#pragma once

#include <memory>
#include <vector>

#include "circuit/parts/search_grid.hpp"
#include "circuit/realise.hpp"
#include "circuit/stages/stage_form.hpp"

namespace bodesmith::circuit {

/// Exchanges resistors of all stages for their neighbours in the series, two at a time (of one stage or of
/// two), while max. |ln(H/H_wanted)| (weighted) of the whole chain over the grid falls. `values`: a stage each,
/// in the order of its form's parts(). Returns that error.
double polish_parts(const std::vector<std::unique_ptr<StageForm>>& forms, const RealiseOptions& options,
                    const SearchGrid& grid, std::vector<std::vector<double>>& values);

}  // namespace bodesmith::circuit
