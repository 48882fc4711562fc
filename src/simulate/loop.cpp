#include "simulate/loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/whole_number.hpp"

namespace bodesmith::simulate {
namespace {

/// What y was at the crossings of one level in one direction.
struct Crossings {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  void add(double y) {
    min = std::min(min, y);
    max = std::max(max, y);
  }
  bool any() const { return max >= min; }
};

}  // namespace

Loop hysteresis_loop(std::span<const double> u, std::span<const double> y, std::size_t levels) {
  if (u.size() != y.size()) throw std::logic_error("a loop needs one output for each input");
  Loop loop;
  if (u.size() < 3 || levels == 0) return loop;
  const auto [low, high] = std::minmax_element(u.begin(), u.end());
  if (!(*high > *low)) return loop;
  const double gap = (*high - *low) / static_cast<double>(levels + 1);
  const auto level = [&, from = *low](std::size_t i) { return from + gap * static_cast<double>(i + 1); };
  std::vector<Crossings> rising(levels);
  std::vector<Crossings> falling(rising.size());
  for (std::size_t k = 1; k < u.size(); ++k) {
    const double from = std::min(u[k - 1], u[k]);
    const double to = std::max(u[k - 1], u[k]);
    const bool up = u[k] > u[k - 1];
    // A level that is met exactly counts where it is left towards, so that it is counted once.
    auto i = whole_number<std::size_t>(std::floor((from - *low) / gap) - 1.0);
    for (; i < levels && level(i) <= to; ++i) {
      const bool crossed = up ? u[k - 1] < level(i) : u[k - 1] > level(i) && u[k] <= level(i);
      if (!crossed) continue;
      const double at = y[k - 1] + (y[k] - y[k - 1]) * (level(i) - u[k - 1]) / (u[k] - u[k - 1]);
      (up ? rising : falling)[i].add(at);
    }
  }
  for (std::size_t i = 0; i < levels; ++i) {
    const Crossings& up = rising[i];
    const Crossings& down = falling[i];
    if (!up.any() || !down.any()) continue;
    const bool below = down.max - up.min >= up.max - down.min;  // the rising branch runs below
    loop.u.push_back(level(i));
    loop.ascending.push_back(below ? up.min : up.max);
    loop.descending.push_back(below ? down.max : down.min);
    loop.height = std::max(loop.height, std::abs(loop.ascending.back() - loop.descending.back()));
  }
  const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
  if (*y_high > *y_low) loop.height_percent = 100.0 * loop.height / (*y_high - *y_low);
  return loop;
}

}  // namespace bodesmith::simulate
