#include "numeric/grunwald_letnikov.hpp"

#include <algorithm>

namespace bodesmith {

void add_difference_weights(double factor, double order, std::span<double> weights) {
  double w = factor;
  for (std::size_t j = 0; j < weights.size() && w != 0.0; ++j) {
    weights[j] += w;
    w *= 1.0 - (order + 1.0) / static_cast<double>(j + 1);
  }
}

std::vector<double> straight_between(std::span<const double> samples, std::size_t parts) {
  if (samples.empty()) return {};
  std::vector<double> out((samples.size() - 1) * parts + 1);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t k = i / parts;
    const double part = static_cast<double>(i % parts) / static_cast<double>(parts);
    out[i] = part > 0.0 ? samples[k] + part * (samples[k + 1] - samples[k]) : samples[k];
  }
  return out;
}

double sum_over_past(std::span<const double> weights, std::span<const double> x, std::size_t now) {
  const std::size_t used = std::min(now + 1, weights.size());
  double sum = 0.0;
  for (std::size_t j = 0; j < used; ++j) sum += weights[j] * x[now - j];
  return sum;
}

}  // namespace bodesmith
