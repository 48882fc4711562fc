#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"

namespace bodesmith::gap {
namespace {

/// Largest difference between the means of kNeighbours samples on both sides of an instant, over the root mean square of all.
double plainest_step(const std::vector<double>& v) {
  constexpr std::size_t n = kNeighbours;
  std::vector<double> sum(v.size() + 1, 0.0);
  for (std::size_t i = 0; i < v.size(); ++i) sum[i + 1] = sum[i] + v[i];
  double largest = 0.0;
  double squares = 0.0;
  for (std::size_t i = n; i + n <= v.size(); ++i) {
    const double step = sum[i + n] - 2.0 * sum[i] + sum[i - n];
    largest = std::max(largest, std::abs(step));
    squares += step * step;
  }
  return squares > 0.0 ? largest / std::sqrt(squares / static_cast<double>(v.size() + 1 - 2 * n)) : 0.0;
}

}  // namespace

/// Chance is taken from surrogates, whose steps are as high as the record's are on the whole: a few edges in the wrong place, of a clock
/// that is named, are no jumps.
Sign jumps(const Leftover& record) {
  return {SignKind::jumps, plainest_step(record.residual) / chance_limit(record.residual, plainest_step)};
}

}  // namespace bodesmith::gap
