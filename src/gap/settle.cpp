#include "gap/settle.hpp"

#include <algorithm>
#include <cmath>

#include "gap/scene.hpp"

namespace bodesmith::gap {

std::size_t unscored_samples(const chain::Chain& base, const TimeRecord& record) {
  const std::size_t n = record.size();
  std::size_t skip = settling_samples(base, record.step_s);
  const auto [low, high] = std::minmax_element(record.u.begin(), record.u.end());
  if (std::abs(record.u.front()) > 0.01 * (*high - *low)) skip = std::max(skip, n * 3 / 100);
  return std::min(skip, n * 2 / 5);
}

}  // namespace bodesmith::gap
