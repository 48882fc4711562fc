#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

// log and atan2 without branches, tables or calls: a compiler makes vectors of loops over them (-fno-trapping-math), and every
// x86-64 gives the same bits, which the vectors of a C library do not. Within 2 units in the last place. Both series are
// interpolated at Chebyshev's points (relative error below 1e-17), with 50 digits.
namespace bodesmith {

/// c0 + c1 x + c2 x² + ...
template <std::size_t N>
constexpr double horner(const double (&c)[N], double x) {
  double value = c[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) value = value * x + c[i];
  return value;
}

/// Natural logarithm of a normal positive number; beyond +-708 in size for zero, denormals, infinity and NaN.
inline double log_of(double x) {
  // x = 2^k m, sqrt(1/2) <= m < sqrt(2); with s = (m - 1)/(m + 1): log m = 2 (s + s^3/3 + s^5/5 + ...).
  constexpr double kSeries[] = {0.66666666666666696, 0.39999999999899505, 0.28571428625975487,
                                0.22222211134795081, 0.18182889125261723, 0.15331721600556042,
                                0.14616449685043406};
  constexpr auto kRootHalf = std::bit_cast<std::uint64_t>(std::numbers::sqrt2 / 2.0);
  constexpr std::uint64_t kMantissa = (std::uint64_t{1} << 52) - 1;
  constexpr std::uint64_t kBias = 1023;
  const std::uint64_t above = std::bit_cast<std::uint64_t>(x) - kRootHalf;
  // The integer k + 1023 as the last digits of 2^52 + k + 1023.
  const double k =
      std::bit_cast<double>(((above + (kBias << 52)) >> 52) | std::bit_cast<std::uint64_t>(0x1p52)) -
      (0x1p52 + static_cast<double>(kBias));
  const double f = std::bit_cast<double>((above & kMantissa) + kRootHalf) - 1.0;
  const double s = f / (2.0 + f);
  const double z = s * s;
  // log 2 in two parts: k times the upper one is exact.
  return k * 0x1.62e42fefa3800p-1 + (f - (s * (f - z * horner(kSeries, z)) - k * 0x1.ef35793c76730p-45));
}

/// The angle of x + jy in radians, -pi to pi; NaN at 0 and where both parts are infinite.
inline double angle_of(double x, double y) {
  // atan t = t - t^3/3 + t^5/5 - ... to t = tan(pi/8); beyond, pi/4 + atan((t - 1)/(t + 1)).
  constexpr double kSeries[] = {-0.33333333333333331,  0.19999999999995521,   -0.14285714284666542,
                                0.11111111015256361,   -0.090909045781239026, 0.076921831908260865,
                                -0.066645114473819475, 0.0585814891280221,    -0.050854497379402598,
                                0.039231658295587189,  -0.01917688711906226};
  constexpr double kTanEighth = std::numbers::sqrt2 - 1.0;
  const double across = std::abs(x);
  const double up = std::abs(y);
  const double larger = across > up ? across : up;
  const double smaller = across > up ? up : across;
  const double far = smaller > kTanEighth * larger ? 1.0 : 0.0;
  const double t = (smaller - far * larger) / (larger + far * smaller);
  const double z = t * t;
  const double within = far * (std::numbers::pi / 4.0) + (t + t * (z * horner(kSeries, z)));
  const double from_above = std::numbers::pi / 2.0 - within;
  const double right = across > up ? within : from_above;
  const double left = std::numbers::pi - right;
  return std::copysign(x < 0.0 ? left : right, y);
}

}  // namespace bodesmith
