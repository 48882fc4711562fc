#pragma once

#include <algorithm>
#include <cmath>

namespace bodesmith::gap {

/// What a figure of merit reaches on surrogates, by chance.
class Chance {
 public:
  void add(double figure) {
    max_ = std::max(max_, figure);
    sum_ += figure;
    sum_of_squares_ += figure * figure;
    ++count_;
  }
  double max() const { return max_; }
  double mean() const { return sum_ / count_; }
  double rms() const { return std::sqrt(sum_of_squares_ / count_); }
  double deviation() const { return std::sqrt(std::max(0.0, sum_of_squares_ / count_ - mean() * mean())); }

 private:
  double max_ = 0.0;
  double sum_ = 0.0;
  double sum_of_squares_ = 0.0;
  int count_ = 0;
};

}  // namespace bodesmith::gap
