#pragma once

#include <cstdint>

namespace bodesmith::chain {

/// The k-th of a row of independent standard normal numbers: a function of (seed, k), so that a noise is the
/// same signal for every engine, step and order of evaluation. SplitMix64 (Steele, Lea, Flood 2014) and
/// Box-Muller.
double normal_number(std::uint64_t seed, std::int64_t k);

}  // namespace bodesmith::chain
