#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/signs/signs.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// A jump, over the usual change of Gaussian noise (which reaches five of its deviations in a million
/// samples).
constexpr double kJump = 8.0;
/// Deviation of Gaussian numbers whose absolute value has the median 1.
constexpr double kDeviationPerMedian = 1.4826;

}  // namespace

Sign jumps(const Leftover& record) {
  Sign sign{SignKind::jumps, 0.0};
  const std::size_t n = record.residual.size();
  std::vector<double> change(n - 1);
  for (std::size_t i = 1; i < n; ++i) change[i - 1] = std::abs(record.residual[i] - record.residual[i - 1]);
  const double largest = *std::max_element(change.begin(), change.end());
  const double usual = kDeviationPerMedian * median(std::move(change));
  sign.strength = usual > 0.0 ? largest / (kJump * usual) : 0.0;
  return sign;
}

}  // namespace bodesmith::gap
