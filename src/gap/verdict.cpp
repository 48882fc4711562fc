#include "gap/verdict.hpp"

#include <algorithm>
#include <array>

namespace bodesmith::gap {

std::string to_string(Verdict verdict) {
  constexpr std::array kWords = {"explained", "partly_explained", "nothing_missing", "unexplained",
                                 "interrupted"};
  return kWords.at(static_cast<std::size_t>(verdict));
}

/// Times the floor that coherence tells: it does not see an instrument's own errors, nor leakage.
constexpr double kEnoughOfCoherence = 1.5;

Verdict verdict_of(const SearchResult& result, double train_rms, double enough) {
  if (result.stopped) return Verdict::interrupted;
  if (result.floor.period == 0) enough = std::max(enough, kEnoughOfCoherence);
  const bool above_floor =
      result.floor.source == NoiseFloor::Source::periods && train_rms > enough * result.floor.rms;
  const bool left = above_floor || !result.structure.empty();
  if (result.steps.empty()) return left ? Verdict::unexplained : Verdict::nothing_missing;
  return left ? Verdict::partly_explained : Verdict::explained;
}

}  // namespace bodesmith::gap
