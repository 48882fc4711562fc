#pragma once

#include <complex>
#include <vector>

#include "fpaa/search/sine_response.hpp"

namespace bodesmith::fpaa {

/// d share / d ln C of a stage's capacitors in its place, on the grid; empty for one that is not there, or (`only_free`) that the continuous fit does not move.
std::vector<std::vector<std::complex<double>>> capacitor_slopes(const StagePlace& place,
                                                                const DesignStage& stage,
                                                                bool only_free = false);

/// How the weighted error changes with one capacitor: d error / d ln C on the grid.
struct CapacitorEffect {
  std::size_t stage = 0;
  std::size_t capacitor = 0;
  std::vector<std::complex<double>> values;
};
/// `only_free`: of those that the continuous fit moves.
std::vector<CapacitorEffect> capacitor_effects(const DesignResponse& response, bool only_free = false);

/// Moves the free capacitors (any real values within what a capacitor may be) to the least squares of the
/// weighted errors, by Levenberg and Marquardt; `passes` > 1 then leans on the points where the error is
/// largest (Lawson's weights), towards the least worst error. What comes out is snapped.
void fit_design(Design& design, const StageFactorTable& table, int iterations, int passes = 1);

}  // namespace bodesmith::fpaa
