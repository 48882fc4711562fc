#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fpaa/search/sine_response.hpp"

namespace bodesmith::fpaa {

/// How the weighted error changes with one capacitor: d error / d ln C on the grid.
struct CapacitorEffect {
  std::size_t stage = 0;
  std::size_t capacitor = 0;
  std::span<const Complex> values;
};
/// Of every capacitor that is there; moved, never copied (each looks into `room`).
struct CapacitorEffects {
  std::vector<CapacitorEffect> list;
  std::unique_ptr<Complex[]> room;
};
/// `only_free`: of those that the continuous fit moves.
CapacitorEffects capacitor_effects(const DesignResponse& response, bool only_free = false);

/// Moves the free capacitors (any real values within what a capacitor may be) to the least squares of the
/// weighted errors, by Levenberg and Marquardt; `passes` > 1 then leans on the points where the error is
/// largest (Lawson's weights), towards the least worst error. What comes out is snapped.
void fit_design(Design& design, const StageFactorTable& table, int iterations, int passes = 1);

}  // namespace bodesmith::fpaa
