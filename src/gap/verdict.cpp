#include "gap/verdict.hpp"

#include <algorithm>

namespace bodesmith::gap {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::explained:
      return "explained";
    case Verdict::partly_explained:
      return "partly_explained";
    case Verdict::nothing_missing:
      return "nothing_missing";
    case Verdict::interrupted:
      return "interrupted";
    case Verdict::unexplained:
      break;
  }
  return "unexplained";
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
