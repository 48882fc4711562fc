#include <algorithm>
#include <cmath>
#include <vector>

#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// A jump, over the usual change of Gaussian noise (which reaches five of its deviations in a million
/// samples).
constexpr double kJump = 8.0;
/// Deviation of Gaussian numbers whose absolute value has the median 1.
constexpr double kDeviationPerMedian = 1.4826;
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
  Sign sign{SignKind::jumps, 0.0};
  const std::vector<double>& v = record.residual;
  std::vector<double> change(v.size() - 1);
  for (std::size_t i = 1; i < v.size(); ++i) change[i - 1] = std::abs(v[i] - v[i - 1]);
  const double largest = *std::max_element(change.begin(), change.end());
  const double usual = kDeviationPerMedian * median(std::move(change));
  if (!(usual > 0.0)) return sign;
  const auto figure = [](const std::vector<double>& of) { return plainest_step(of, kSamplesEachSide); };
  sign.strength = std::max(largest / (kJump * usual), figure(v) / on_surrogates(v, figure).limit());
  return sign;
}

}  // namespace bodesmith::gap
