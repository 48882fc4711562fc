#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"

namespace bodesmith::gap {
namespace {

/// Samples on each side of a jump that may be under the noise of single ones: means of n see one that is 1/sqrt(n) as high.
constexpr std::size_t kSamplesEachSide = 16;

/// Largest difference between the means of `n` samples on both sides of an instant, over the root mean square of all.
double plainest_step(const std::vector<double>& v, std::size_t n) {
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

Sign jumps(const Leftover& record) {
  const std::vector<double>& v = record.residual;
  const auto figure = [](const std::vector<double>& of) { return plainest_step(of, kSamplesEachSide); };
  return {SignKind::jumps, figure(v) / chance_limit(v, figure)};
}

}  // namespace bodesmith::gap
