#include "signal/error_figures.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith {

void ErrorSum::add(std::span<const double> got, std::span<const double> reference, std::size_t first) {
  double sum = 0.0;
  double own = 0.0;
  for (std::size_t i = first; i < reference.size(); ++i) {
    const double error = got[i] - reference[i];
    squares_ += error * error;
    sum += error;
    own += error * error;
    max_ = std::max(max_, std::abs(error));
    low_ = std::min(low_, reference[i]);
    high_ = std::max(high_, reference[i]);
  }
  if (first >= reference.size()) return;
  around_means_ += std::max(0.0, own - sum * sum / static_cast<double>(reference.size() - first));
  count_ += reference.size() - first;
}

ErrorFigures ErrorSum::figures() const {
  ErrorFigures out;
  if (count_ == 0) return out;
  out.rms = std::sqrt(squares_ / static_cast<double>(count_));
  out.rms_free_offset = std::sqrt(around_means_ / static_cast<double>(count_));
  out.max = max_;
  out.range = high_ - low_;
  if (out.range > 0.0) {
    out.rms_percent = 100.0 * out.rms / out.range;
    out.max_percent = 100.0 * out.max / out.range;
  }
  return out;
}

ErrorFigures error_figures(std::span<const double> got, std::span<const double> reference,
                           std::size_t first) {
  ErrorSum sum;
  sum.add(got, reference, first);
  return sum.figures();
}

}  // namespace bodesmith
