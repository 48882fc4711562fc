#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bodesmith {

/// Of a table over rising keys: piecewise linear, held at its ends.
inline double interpolated(const std::vector<double>& key, const std::vector<double>& value, double at) {
  if (at <= key.front()) return value.front();
  if (at >= key.back()) return value.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(key.begin(), key.end(), at) - key.begin());
  return value[i - 1] + (at - key[i - 1]) / (key[i] - key[i - 1]) * (value[i] - value[i - 1]);
}

}  // namespace bodesmith
