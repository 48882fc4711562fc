#pragma once

#include <array>
#include <cstdint>

namespace bodesmith {

/// Philox4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3, SC 2011): four
/// words from a counter and a key and nothing else, so that sample number n is the same whichever thread or
/// machine draws it.
inline std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
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

/// Two numbers in (0, 1) for (seed, sample, pair).
inline std::array<double, 2> uniform_pair(std::uint64_t seed, std::uint64_t sample, std::uint32_t pair) {
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
/// PPND16).
double normal_quantile(double p);

}  // namespace bodesmith
