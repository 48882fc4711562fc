#pragma once

#include "fpaa/search/score.hpp"

namespace bodesmith::fpaa {

/// Pairs of capacitors of any stages, each up and down by a few units together, found with the first derivatives and
/// judged by the exact response: what a single capacitor spoils another one may mend. The spread by mismatch counts
/// beside the error.
void polish_pairs(Design& design, const StageFactorTable& table, const MismatchModel& mismatch, int rounds);

}  // namespace bodesmith::fpaa
