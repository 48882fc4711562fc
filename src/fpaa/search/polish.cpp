#include <algorithm>
#include <cmath>

#include "fpaa/search/whole_capacitors.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kPolishSteps[] = {1.0, -1.0, 2.0, -2.0, 4.0, -4.0};
constexpr std::size_t kJudgedPairs = 8;  ///< of each round, by the exact response

/// One capacitor by some units, and what that does to the weighted errors (first order in ln C).
struct UnitMove {
  std::size_t stage = 0;
  std::size_t capacitor = 0;
  double step = 0.0;
  std::vector<Complex> change;
};

/// |e|^8: nearly the largest, but something is gained too where one of two equal peaks gets smaller.
double eighth_power(double squared) {
  const double fourth = squared * squared;
  return fourth * fourth;
}

std::vector<UnitMove> unit_moves(const CapacitorEffects& effects, const Design& design) {
  std::vector<UnitMove> out;
  for (const CapacitorEffect& effect : effects.list) {
    const DesignStage& stage = design.stages[effect.stage];
    const double units = stage.c[effect.capacitor];
    for (const double step : kPolishSteps) {
      if (units + step < 1.0) continue;
      if (units + step > stage.largest_units(effect.capacitor)) continue;
      UnitMove move{effect.stage, effect.capacitor, step, {effect.values.begin(), effect.values.end()}};
      const double by = std::log1p(step / units);
      for (Complex& change : move.change) change *= by;
      out.push_back(std::move(move));
    }
  }
  return out;
}

/// Two moves (the second may be missing) and what the first derivatives promise.
struct MovePair {
  std::size_t first = 0;
  std::size_t second = 0;
  double promised = 0.0;
};

/// The most promising pairs. Points of large errors are summed first, so that most pairs are left early.
std::vector<MovePair> promising_pairs(const std::vector<UnitMove>& moves,
                                      const std::vector<Complex>& errors) {
  std::vector<std::size_t> order(errors.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return std::norm(errors[a]) > std::norm(errors[b]); });
  double bound = 0.0;
  for (const Complex& e : errors) bound += eighth_power(std::norm(e));
  std::vector<MovePair> out;
  for (std::size_t a = 0; a < moves.size(); ++a) {
    for (std::size_t b = a; b < moves.size(); ++b) {
      const bool same = moves[a].stage == moves[b].stage && moves[a].capacitor == moves[b].capacitor;
      if (same && a != b) continue;
      const double two = a == b ? 0.0 : 1.0;
      double sum = 0.0;
      for (const std::size_t k : order) {
        sum += eighth_power(std::norm(errors[k] + moves[a].change[k] + two * moves[b].change[k]));
        if (!(sum < kBetter * bound)) break;
      }
      if (!(sum < kBetter * bound)) continue;
      const MovePair pair{a, b, sum};
      out.insert(std::ranges::find_if(out, [&](const MovePair& p) { return sum < kBetter * p.promised; }),
                 pair);
      if (out.size() > kJudgedPairs) out.pop_back();
      if (out.size() == kJudgedPairs) bound = out.back().promised;
    }
  }
  return out;
}

Design with_moves(const Design& design, const UnitMove& first, const UnitMove* second) {
  Design out = design;
  out.stages[first.stage].c[first.capacitor] += first.step;
  if (second != nullptr) out.stages[second->stage].c[second->capacitor] += second->step;
  return out;
}

}  // namespace

void polish_pairs(Design& design, const StageFactorTable& table, const MismatchModel& mismatch, int rounds) {
  struct Judged {
    double smooth = 0.0;  ///< sum of eighth powers
    double largest = 0.0;
    CapacitorEffects effects;
    std::vector<Complex> errors;
  };
  const auto judge = [&](const Design& d) {
    const DesignResponse response(d, table);
    Judged out;
    out.effects = capacitor_effects(response);
    out.errors = response.errors();
    for (const double own : errors_of_95_percent(out.errors, out.effects, d, mismatch)) {
      out.smooth += eighth_power(own * own);
      out.largest = std::max(out.largest, own);
    }
    return out;
  };
  Design at = design;
  Judged now = judge(at);
  double least = now.largest;
  if (!std::isfinite(now.smooth)) return;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<UnitMove> moves = unit_moves(now.effects, at);
    bool moved = false;
    for (const MovePair& pair : promising_pairs(moves, now.errors)) {
      const UnitMove* second = pair.first == pair.second ? nullptr : &moves[pair.second];
      Design next = with_moves(at, moves[pair.first], second);
      const bool stable =
          std::ranges::all_of(next.stages, [](const DesignStage& stage) { return stage.is_stable(); });
      if (!stable) continue;
      Judged got = judge(next);
      if (!(got.smooth < kBetter * now.smooth)) continue;
      at = std::move(next);
      now = std::move(got);
      moved = true;
      break;
    }
    if (!moved) break;
    if (now.largest < kBetter * least) {
      least = now.largest;
      design = at;
    }
  }
}

}  // namespace bodesmith::fpaa
