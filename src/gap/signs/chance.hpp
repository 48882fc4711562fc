#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gap/search_options.hpp"
#include "signal/periodogram.hpp"

namespace bodesmith::gap {

/// A sign is more than so many deviations above the mean of what chance makes.
inline constexpr double kDeviations = 7.0;

/// Deviations of the correlation of neighbouring points of a response that are certainly alike; of heavy-tailed errors it has a larger
/// deviation than counted. Ten points cannot reach it.
inline constexpr double kAlike = 5.0;

/// Of the energy, what a sign must hold: less has no name, however sure.
inline constexpr double kLeastShare = BoundOptions().explained * BoundOptions().explained;

/// What a figure of merit reaches on surrogates, by chance.
class Chance {
 public:
  void add(double figure) {
    max_ = std::max(max_, figure);
    sum_ += figure;
    sum_of_squares_ += figure * figure;
    ++count_;
  }
  /// Beyond what chance does: a false sign costs more than a missed one, and a record is looked at in a dozen ways.
  double limit() const { return mean() + kDeviations * deviation(); }
  double max() const { return max_; }
  double mean() const { return sum_ / count_; }
  double deviation() const { return std::sqrt(std::max(0.0, sum_of_squares_ / count_ - mean() * mean())); }

 private:
  double max_ = 0.0;
  double sum_ = 0.0;
  double sum_of_squares_ = 0.0;
  int count_ = 0;
};

/// Surrogates (same spectrum, random phases) of a residual that chance is taken from.
inline constexpr std::uint64_t kSurrogates = 24;

/// What a figure of a residual reaches on its surrogates.
template <class Figure>
Chance on_surrogates(const std::vector<double>& residual, Figure figure) {
  Chance chance;
  for (std::uint64_t k = 0; k < kSurrogates; ++k) chance.add(figure(phase_surrogate(residual, k)));
  return chance;
}

}  // namespace bodesmith::gap
