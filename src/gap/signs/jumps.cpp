#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {

Sign jumps(const Leftover& record) {
  const std::vector<double>& v = record.residual;
  std::vector<double> sum(v.size() + 1, 0.0);
  for (std::size_t i = 0; i < v.size(); ++i) sum[i + 1] = sum[i] + v[i];
  // Differences between means over kNeighbours samples on both sides of an instant, but for a factor.
  std::vector<double> steps;
  for (std::size_t i = kNeighbours; i + kNeighbours <= v.size(); ++i)
    steps.push_back(std::abs(sum[i + kNeighbours] - 2.0 * sum[i] + sum[i - kNeighbours]));
  if (steps.empty()) return {SignKind::jumps, 0.0};
  const double largest = *std::max_element(steps.begin(), steps.end());
  // Noise of any colour has them normal: half of them lie within .6745 deviations, and the square of the largest of n about 2 ln n above.
  const double deviation = std::max(median(steps) / 0.6745, 1e-300);
  const double limit = std::sqrt(2.0 * (std::log(static_cast<double>(steps.size())) + kLogDeviations));
  return {SignKind::jumps, largest / deviation / limit};
}

}  // namespace bodesmith::gap
