#include "gap/records/one_loop.hpp"

#include <algorithm>
#include <vector>

namespace bodesmith::gap {
namespace {

/// Part of a signal's span beyond which a turn counts, and within which turns are one.
constexpr double kTurn = 0.05;

/// Where a signal turns.
struct Turns {
  std::vector<double> lower;
  std::vector<double> upper;
};
Turns turns_of(const Signal& signal) {
  Turns turns;
  double low = signal.values.front();
  double high = low;
  int direction = 0;
  for (const double v : signal.values) {
    low = direction > 0 ? low : std::min(low, v);
    if (direction >= 0) high = std::max(high, v);
    if (direction <= 0 && v > low + kTurn * signal.span()) {
      if (direction < 0) turns.lower.push_back(low);
      direction = 1;
      high = v;
    } else if (direction >= 0 && v < high - kTurn * signal.span()) {
      if (direction > 0) turns.upper.push_back(high);
      direction = -1;
      low = v;
    }
  }
  // The way in from the start goes elsewhere, and so may the first turn behind it.
  if (turns.lower.size() > 2) turns.lower.erase(turns.lower.begin());
  if (turns.upper.size() > 2) turns.upper.erase(turns.upper.begin());
  return turns;
}

bool lie_together(const std::vector<double>& values, double span) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return values.empty() || *most - *least < kTurn * span;
}

}  // namespace

bool is_one_loop(const Scene& scene, std::size_t at) {
  if (scene.records != 1) return false;
  const auto turns = turns_of(scene.boundary[at]);
  return lie_together(turns.lower, scene.boundary[at].span()) &&
         lie_together(turns.upper, scene.boundary[at].span());
}

}  // namespace bodesmith::gap
