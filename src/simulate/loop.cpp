#include "simulate/loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bodesmith::simulate {
namespace {

/// What y was at the crossings of one level in one direction.
struct Crossings {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  void add(double y) {
    least = std::min(least, y);
    most = std::max(most, y);
  }
  bool any() const { return most >= least; }
};

}  // namespace

Loop hysteresis_loop(std::span<const double> u, std::span<const double> y, int levels) {
  if (u.size() != y.size()) throw std::logic_error("a loop needs one output for each input");
  Loop loop;
  if (u.size() < 3 || levels < 1) return loop;
  const auto [low, high] = std::minmax_element(u.begin(), u.end());
  if (!(*high > *low)) return loop;
  const double gap = (*high - *low) / (levels + 1);
  const auto level = [&](int i) { return *low + gap * (i + 1); };
  std::vector<Crossings> rising(static_cast<std::size_t>(levels));
  std::vector<Crossings> falling(rising.size());
  for (std::size_t k = 1; k < u.size(); ++k) {
    const double from = std::min(u[k - 1], u[k]);
    const double to = std::max(u[k - 1], u[k]);
    const bool up = u[k] > u[k - 1];
    // A level that is met exactly counts where it is left towards, so that it is counted once.
    int i = std::max(0, static_cast<int>(std::floor((from - *low) / gap)) - 1);
    for (; i < levels && level(i) <= to; ++i) {
      const bool crossed = up ? u[k - 1] < level(i) : u[k - 1] > level(i) && u[k] <= level(i);
      if (!crossed) continue;
      const double at = y[k - 1] + (y[k] - y[k - 1]) * (level(i) - u[k - 1]) / (u[k] - u[k - 1]);
      (up ? rising : falling)[static_cast<std::size_t>(i)].add(at);
    }
  }
  for (int i = 0; i < levels; ++i) {
    const Crossings& up = rising[static_cast<std::size_t>(i)];
    const Crossings& down = falling[static_cast<std::size_t>(i)];
    if (!up.any() || !down.any()) continue;
    const bool below = down.most - up.least >= up.most - down.least;  // the rising branch runs below
    loop.u.push_back(level(i));
    loop.ascending.push_back(below ? up.least : up.most);
    loop.descending.push_back(below ? down.most : down.least);
    loop.height = std::max(loop.height, std::abs(loop.ascending.back() - loop.descending.back()));
  }
  const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
  if (*y_high > *y_low) loop.height_percent = 100.0 * loop.height / (*y_high - *y_low);
  return loop;
}

}  // namespace bodesmith::simulate
