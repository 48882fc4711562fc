#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "signal/periodogram.hpp"

namespace bodesmith::gap {

/// A sign is more than so many deviations above the mean of what chance makes: a false one costs more than a missed one, and a record
/// is looked at in a dozen ways. Of a logarithm of a likelihood that is half of their square.
inline constexpr double kDeviations = 7.0;
inline constexpr double kLogDeviations = kDeviations * kDeviations / 2.0;

/// What is usual so many tell: of the bins or samples on each side levels around a line, means around a jump (which see one that is a quarter
/// of the noise of single samples); of surrogates (same spectrum, random phases) what chance reaches. Of outputs as many earlier ones, curves
/// and slow gains are looked at.
inline constexpr std::size_t kNeighbours = 16;

/// Beyond what a figure of a residual reaches on its surrogates.
template <class Figure>
double chance_limit(const std::vector<double>& residual, Figure figure) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::uint64_t k = 0; k < kNeighbours; ++k) {
    const double reached = figure(phase_surrogate(residual, k));
    sum += reached / kNeighbours;
    squares += reached * reached / kNeighbours;
  }
  return sum + kDeviations * std::sqrt(std::max(0.0, squares - sum * sum));
}

}  // namespace bodesmith::gap
