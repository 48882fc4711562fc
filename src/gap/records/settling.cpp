#include "gap/records/settling.hpp"

#include <algorithm>
#include <cmath>

#include "base/whole_number.hpp"

namespace bodesmith::gap {
namespace {

/// exp(-7) is a thousandth: below the noise of any record.
constexpr double kTimeConstants = 7.0;
/// An input below this part of its range begins at zero.
constexpr double kZero = 0.01;

/// Samples after which a model forgets its initial state.
std::size_t settling_samples(const chain::Chain& chain, double step_s) {
  double slowest = 0.0;
  for (const auto& block : chain.blocks) slowest = std::max(slowest, block.slowest_time_constant_s());
  return whole_number<std::size_t>(kTimeConstants * slowest / step_s);
}

}  // namespace

bool begins_under_bias(const TimeRecord& record) {
  const auto [low, high] = std::minmax_element(record.u.begin(), record.u.end());
  return std::abs(record.u.front()) > kZero * (*high - *low);
}

std::size_t start_samples(const chain::Chain& base, const TimeRecord& record) {
  const std::size_t n = record.size();
  std::size_t start = settling_samples(base, record.step_s);
  if (begins_under_bias(record)) start = std::max(start, n * 3 / 100);
  return std::min(start, n * 2 / 5);
}

}  // namespace bodesmith::gap
