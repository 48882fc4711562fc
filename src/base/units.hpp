#pragma once

#include <cmath>
#include <compare>
#include <complex>
#include <numbers>

namespace bodesmith {

/// A phasor, a response, a root.
using Complex = std::complex<double>;

struct RadPerSecond;

/// A frequency in hertz. Frequencies travel between modules only as Hertz or RadPerSecond, never as bare
/// doubles.
struct Hertz {
  double value = 0.0;
  constexpr RadPerSecond rad_s() const;
  friend constexpr auto operator<=>(const Hertz&, const Hertz&) = default;
};

/// An angular frequency in radians per second.
struct RadPerSecond {
  double value = 0.0;
  constexpr Hertz hz() const { return Hertz{value / (2.0 * std::numbers::pi)}; }
  friend constexpr auto operator<=>(const RadPerSecond&, const RadPerSecond&) = default;
};

constexpr RadPerSecond Hertz::rad_s() const {
  return RadPerSecond{value * 2.0 * std::numbers::pi};
}

/// One neper in decibels: 20/ln 10.
inline constexpr double kDecibelPerNeper = 8.685889638065036553;

/// 20 log10 |gain|; -infinity for a gain of 0.
inline double to_decibel(double gain) {
  return 20.0 * std::log10(std::abs(gain));
}
inline double from_decibel(double decibel) {
  return std::pow(10.0, decibel / 20.0);
}
inline constexpr double to_degrees(double radians) {
  return radians * (180.0 / std::numbers::pi);
}
inline constexpr double to_radians(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}

}  // namespace bodesmith
