#include "gap/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::gap {

double mean(const std::vector<double>& v) {
  double sum = 0.0;
  for (double x : v) sum += x;
  return v.empty() ? 0.0 : sum / static_cast<double>(v.size());
}

double rms(const std::vector<double>& v) {
  double sum = 0.0;
  for (double x : v) sum += x * x;
  return v.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(v.size()));
}

double median(std::vector<double> v) {
  return quantile(std::move(v), 0.5);
}

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return 0.0;
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(v.size() - 1) + 0.5);
  std::nth_element(v.begin(), v.begin() + k, v.end());
  return v[static_cast<std::size_t>(k)];
}

double correlation_time(const std::vector<double>& v) {
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

double block_z(const std::vector<double>& v) {
  const std::size_t n = v.size();
  if (n < 16) return 0.0;
  const auto longest = std::max<std::size_t>(1, n / 16);
  const auto length = std::clamp<std::size_t>(static_cast<std::size_t>(4.0 * correlation_time(v)),
                                              std::max<std::size_t>(1, n / 64), longest);
  const std::size_t blocks = n / length;
  std::vector<double> means(blocks, 0.0);
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t i = 0; i < length; ++i) means[b] += v[b * length + i];
    means[b] /= static_cast<double>(length);
  }
  const double middle = mean(means);
  double spread = 0.0;
  for (double m : means) spread += (m - middle) * (m - middle);
  spread = std::sqrt(spread / static_cast<double>(blocks - 1) / static_cast<double>(blocks));
  if (!(spread > 0.0)) return middle > 0.0 ? 1e9 : middle < 0.0 ? -1e9 : 0.0;
  return middle / spread;
}

}  // namespace bodesmith::gap
