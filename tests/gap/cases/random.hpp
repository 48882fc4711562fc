#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

/// Random numbers of the hidden cases: the same on every machine (the standard library's distributions are
/// not).
namespace hidden {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

using Random = std::mt19937_64;

inline double uniform(Random& random, double a, double b) {
  return a + (b - a) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
}
inline double log_uniform(Random& random, double a, double b) {
  return a * std::pow(b / a, uniform(random, 0.0, 1.0));
}
inline double normal(Random& random) {
  const double a = uniform(random, 1e-12, 1.0);
  return std::sqrt(-2.0 * std::log(a)) * std::cos(2.0 * std::numbers::pi * uniform(random, 0.0, 1.0));
}
inline bool coin(Random& random) {
  return (random() >> 40 & 1U) != 0;
}
/// One of a list.
template <class T>
const T& pick(Random& random, const std::vector<T>& from) {
  return from[static_cast<std::size_t>(uniform(random, 0.0, 1.0) * static_cast<double>(from.size()))];
}

}  // namespace hidden
