#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace bodesmith {

// Random numbers that are the same on every machine and with every standard library (the standard's
// distributions are not; its engine std::mt19937_64 is, and unit_interval() below makes numbers of its
// words).

/// The finaliser of SplitMix64 (Steele, Lea and Flood: Fast splittable pseudorandom number generators, OOPSLA
/// 2014): every bit of z moves every bit of the result.
constexpr std::uint64_t mixed_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/// A number in [0, 1) from 64 random bits, a multiple of 2^-53.
constexpr double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}
/// A number in (0, 1]: its logarithm is finite.
constexpr double open_unit_interval(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

/// A standard normal number (Box and Muller, Ann. Math. Stat. 29 (1958) 610) from ln u and v, u in (0, 1] and
/// v in [0, 1) independent and uniform.
inline double box_muller(double log_u, double v) {
  return std::sqrt(-2.0 * log_u) * std::cos(2.0 * std::numbers::pi * v);
}

/// SplitMix64, one number after the other.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() { return mixed_bits(state_ += kGolden); }
  /// In [0, 1).
  double uniform() { return unit_interval(next()); }
  /// Mean 0, standard deviation 1.
  double normal() {
    const double log_u = std::log1p(-uniform());
    return box_muller(log_u, uniform());
  }
  /// In 0 … n − 1.
  std::uint64_t below(std::uint64_t n) {
    return static_cast<std::uint64_t>(uniform() * static_cast<double>(n));
  }

  static constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;  ///< 2^64 over the golden ratio

 private:
  std::uint64_t state_;
};

/// The k-th of a row of independent standard normal numbers: a function of (seed, k) and nothing else, so
/// that a noise is the same signal for every engine, step and order of evaluation. SplitMix64 and Box-Muller.
double normal_number(std::uint64_t seed, std::int64_t k);

/// Philox4x32-10 (Salmon, Moraes, Dror and Shaw: Parallel random numbers: as easy as 1, 2, 3, SC 2011): four
/// words from a counter and a key and nothing else, so that sample number n is the same whichever thread or
/// machine draws it.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                              std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9;
    key[1] += 0xBB67AE85;
  }
  return counter;
}

/// Two numbers in (0, 1) for (seed, sample, pair), by philox().
constexpr std::array<double, 2> uniform_pair(std::uint64_t seed, std::uint64_t sample, std::uint32_t pair) {
  const auto w =
      philox({static_cast<std::uint32_t>(sample), static_cast<std::uint32_t>(sample >> 32), pair, 0},
             {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
  const auto open = [](std::uint32_t high, std::uint32_t low) {
    const std::uint64_t bits = (std::uint64_t{high} << 20) ^ (low >> 12);
    return (static_cast<double>(bits) + 0.5) * 0x1p-52;
  };
  return {open(w[0], w[1]), open(w[2], w[3])};
}

/// Quantile of the standard normal distribution, relative error below 1e-15 (Wichura, algorithm AS 241,
/// PPND16, Appl. Stat. 37 (1988) 477).
double normal_quantile(double p);

}  // namespace bodesmith
