#include "yield/histogram.hpp"

#include <algorithm>
#include <numeric>

namespace bodesmith::yield {

double Histogram::quantile(double p) const {
  const std::uint64_t total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  if (total == 0) return 0.0;
  if (p <= 0.0) return min;
  if (p >= 1.0) return max;
  const double target = p * static_cast<double>(total);
  const double width = (high - low) / static_cast<double>(counts.size());
  double before = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double here = static_cast<double>(counts[i]);
    if (before + here >= target && here > 0.0) {
      return std::clamp(low + width * (static_cast<double>(i) + (target - before) / here), min, max);
    }
    before += here;
  }
  return max;
}

}  // namespace bodesmith::yield
