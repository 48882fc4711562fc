#pragma once

#include <cstddef>

#include "gap/search_options.hpp"

namespace bodesmith::gap {

/// A sign is more than so many deviations above the mean of what chance makes: a false one costs more than a missed one, and a record
/// is looked at in a dozen ways. Of a logarithm of a likelihood that is half of their square.
inline constexpr double kDeviations = 7.0;
inline constexpr double kLogDeviations = kDeviations * kDeviations / 2.0;

/// What is usual around a sample so many on each side tell: levels around a line, means around a jump (which see one that is a quarter of
/// the noise of single samples). Of outputs as many earlier ones, curves and slow gains are looked at.
inline constexpr std::size_t kNeighbours = 16;

}  // namespace bodesmith::gap
