#include "signal/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "base/whole_number.hpp"

namespace bodesmith {

double mean(std::span<const double> v) {
  double sum = 0.0;
  for (double x : v) sum += x;
  return v.empty() ? 0.0 : sum / static_cast<double>(v.size());
}

double rms(std::span<const double> v) {
  double sum = 0.0;
  for (double x : v) sum += x * x;
  return v.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(v.size()));
}

double median(std::vector<double> v) {
  return quantile(std::move(v), 0.5);
}

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return 0.0;
  const double place = q * static_cast<double>(v.size() - 1);
  const auto below = v.begin() + whole_number<std::ptrdiff_t>(place);
  std::nth_element(v.begin(), below, v.end());
  const double share = place - std::floor(place);
  return share > 0.0 ? *below + share * (*std::min_element(below + 1, v.end()) - *below) : *below;
}

double quantile_of_sorted(std::span<const double> sorted, double q) {
  if (sorted.empty()) return 0.0;
  const double place = q * static_cast<double>(sorted.size() - 1);
  const auto i = whole_number<std::size_t>(place);
  const double next = sorted[std::min(i + 1, sorted.size() - 1)];
  return sorted[i] + (place - static_cast<double>(i)) * (next - sorted[i]);
}

double correlation_time(std::span<const double> v) {
  const std::size_t n = v.size();
  if (n < 8) return 1.0;
  const double middle = mean(v);
  double energy = 0.0;
  for (double x : v) energy += (x - middle) * (x - middle);
  if (!(energy > 0.0)) return 1.0;
  double time = 1.0;
  for (std::size_t k = 1; k < n / 4; ++k) {
    double sum = 0.0;
    for (std::size_t i = k; i < n; ++i) sum += (v[i] - middle) * (v[i - k] - middle);
    const double rho = sum / energy;
    if (rho < 0.05) break;
    time += 2.0 * rho;
    // Long memories need not be followed lag by lag.
    if (k > 64) k += k / 8;
  }
  return std::min(time, static_cast<double>(n) / 4.0);
}

std::vector<double> less_straight_line(const std::vector<double>& v) {
  const double middle = 0.5 * static_cast<double>(v.size() - 1);
  const double level = mean(v);
  double along = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double t = static_cast<double>(i) - middle;
    along += t * v[i];
    size += t * t;
  }
  std::vector<double> out(v.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    out[i] = v[i] - level - (size > 0.0 ? along / size : 0.0) * (static_cast<double>(i) - middle);
  return out;
}

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
