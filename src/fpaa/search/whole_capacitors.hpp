#pragma once

#include "fpaa/device/mismatch.hpp"
#include "fpaa/search/fit.hpp"
#include "fpaa/search/score.hpp"

namespace bodesmith::fpaa {

/// A choice is better when it is so by more than this share: nothing depends on last bits.
inline constexpr double kBetter = 1.0 - 1e-7;

/// Capacitors of a stage that may be scaled together without a change of the response.
std::vector<std::vector<std::size_t>> scale_groups(const DesignStage& stage);

/// How much is kept while stages become whole one after the other.
struct RoundingWidth {
  std::size_t designs = 1;      ///< partly whole designs kept after each stage
  std::size_t choices = 1;      ///< sets of whole capacitors tried for a stage of each
  MismatchModel mismatch = {};  ///< its spread counts in addition to the error
};
/// Whole capacitors: stage by stage the scales that cost least, the capacitors not yet whole fitted again after
/// each; designs are compared with what is left fitted. False where some stage cannot be made (a capacitor
/// below half a unit).
bool make_whole(Design& design, const StageFactorTable& table, RoundingWidth width = {});

/// Pairs of capacitors of any stages, each up and down by a few units together, found with the first derivatives and
/// judged by the exact response: what a single capacitor spoils another one may mend. The spread by mismatch counts
/// in addition to the error.
void polish_pairs(Design& design, const StageFactorTable& table, const MismatchModel& mismatch, int rounds);

}  // namespace bodesmith::fpaa
