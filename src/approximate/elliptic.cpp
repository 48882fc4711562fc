#include "approximate/elliptic.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace bodesmith {
namespace {

/// Where the two means have met, relative: a few roundings.
constexpr long double kMeansMeet = 1e-19L;

}  // namespace

EllipticFunctions jacobi_elliptic(long double argument, long double complementary_modulus) {
  // am(u) by the arithmetic-geometric mean: phi_N = 2^N a_N u, sin(2 phi_(n-1) - phi_n) = (c_n/a_n) sin phi_n
  // (Abramowitz and Stegun, 16.4).
  std::array<long double, 32> a{};
  std::array<long double, 32> c{};
  long double b = complementary_modulus;
  a[0] = 1.0L;
  std::size_t n = 0;
  while (n + 1 < a.size() && std::abs(a[n] - b) > kMeansMeet * a[n]) {
    c[n + 1] = 0.5L * (a[n] - b);
    a[n + 1] = 0.5L * (a[n] + b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  long double phi = std::ldexp(a[n] * argument, static_cast<int>(n));
  for (std::size_t i = n; i > 0; --i) phi = 0.5L * (phi + std::asin(c[i] / a[i] * std::sin(phi)));
  const long double sn = std::sin(phi);
  const long double cn = std::cos(phi);
  return {sn, cn, std::sqrt(cn * cn + complementary_modulus * complementary_modulus * sn * sn)};
}

}  // namespace bodesmith
