#include "gap/records/one_loop.hpp"

#include <algorithm>
#include <vector>

#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Parts of a signal's span: a turn counts beyond the first, and turns within the second of each other are one.
constexpr double kTurn = 0.02;
constexpr double kSameTurn = 0.05;
/// Loops take the same time when none takes longer than another by this factor.
constexpr double kSameTime = 1.2;

/// Where a signal turns.
struct Turns {
  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<std::size_t> upper_at;  ///< samples
};
Turns turns_of(const Signal& signal) {
  Turns turns;
  double low = signal.values.front();
  double high = low;
  std::size_t high_at = 0;
  int direction = 0;
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    const double v = signal.values[i];
    low = direction > 0 ? low : std::min(low, v);
    if (direction >= 0 && v > high) {
      high = v;
      high_at = i;
    }
    if (direction <= 0 && v > low + kTurn * signal.span()) {
      if (direction < 0) turns.lower.push_back(low);
      direction = 1;
      high = v;
      high_at = i;
    } else if (direction >= 0 && v < high - kTurn * signal.span()) {
      if (direction > 0) {
        turns.upper.push_back(high);
        turns.upper_at.push_back(high_at);
      }
      direction = -1;
      low = v;
    }
  }
  // The way in from the start goes elsewhere, and so may the first turn behind it.
  if (turns.lower.size() > 2) turns.lower.erase(turns.lower.begin());
  if (turns.upper.size() > 2) {
    turns.upper.erase(turns.upper.begin());
    turns.upper_at.erase(turns.upper_at.begin());
  }
  return turns;
}

bool lie_together(const std::vector<double>& values, double span) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return values.empty() || *most - *least < kSameTurn * span;
}

}  // namespace

bool is_one_loop(const Scene& scene, std::size_t at) {
  if (scene.records != 1) return false;
  const auto turns = turns_of(scene.boundary[at]);
  return lie_together(turns.lower, scene.boundary[at].span()) &&
         lie_together(turns.upper, scene.boundary[at].span());
}

namespace {

/// The same with every loop taking as long: memory and lag look alike in it.
bool is_one_loop_of_one_speed(const Scene& scene, std::size_t at) {
  if (!is_one_loop(scene, at)) return false;
  const auto turned = turns_of(scene.boundary[at]).upper_at;
  std::vector<double> times;
  for (std::size_t k = 1; k < turned.size(); ++k)
    times.push_back(static_cast<double>(turned[k] - turned[k - 1]));
  const auto [least, most] = std::minmax_element(times.begin(), times.end());
  return times.empty() || *most < kSameTime * *least;
}

}  // namespace

bool memory_may_bend(const Scene& scene, std::size_t at) {
  const auto& terms = scene.model->terms();
  const bool memory = std::any_of(terms.begin(), terms.end(),
                                  [](const Term& term) { return term.effect->name() == "hysteresis"; });
  const bool lag =
      std::any_of(terms.begin(), terms.end(), [](const Term& term) { return term.effect->facts().linear; });
  return (memory && is_one_loop(scene, at)) || (lag && is_one_loop_of_one_speed(scene, at));
}

}  // namespace bodesmith::gap
