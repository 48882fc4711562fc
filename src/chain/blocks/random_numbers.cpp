#include "chain/blocks/random_numbers.hpp"

#include <cmath>
#include <numbers>

namespace bodesmith::chain {
namespace {

std::uint64_t mixed(std::uint64_t z) {
  z += 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

}  // namespace

double normal_number(std::uint64_t seed, std::int64_t k) {
  const std::uint64_t a = mixed(mixed(seed) ^ static_cast<std::uint64_t>(k));
  const std::uint64_t b = mixed(a);
  const double u = (static_cast<double>(a >> 11) + 0.5) * 0x1p-53;
  const double v = static_cast<double>(b >> 11) * 0x1p-53;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace bodesmith::chain
