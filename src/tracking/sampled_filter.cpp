#include "tracking/sampled_filter.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::tracking {

SampledFilter::SampledFilter(const ClockedCompensator& compensator) : gain_(compensator.gain) {
  for (const auto& section : compensator.sections) {
    Section f;
    const double a0 = section.denominator.at(0);
    const std::size_t order = std::max(section.numerator.size(), section.denominator.size());
    for (std::size_t i = 0; i < order; ++i) {
      f.b.push_back(i < section.numerator.size() ? section.numerator[i] / a0 : 0.0);
      f.a.push_back(i < section.denominator.size() ? section.denominator[i] / a0 : 0.0);
    }
    f.state.assign(order, 0.0);
    sections_.push_back(std::move(f));
  }
}

double SampledFilter::next(double u) {
  double v = gain_ * u;
  for (Section& f : sections_) {
    const double y = f.b[0] * v + f.state[0];
    for (std::size_t i = 1; i < f.b.size(); ++i) {
      f.state[i - 1] = f.b[i] * v - f.a[i] * y + (i + 1 < f.b.size() ? f.state[i] : 0.0);
    }
    v = y;
  }
  return v;
}

std::size_t memory_samples(const ClockedCompensator& compensator) {
  constexpr std::size_t kMaxSamples = 2'000'000;
  SampledFilter filter(compensator);
  double total = std::abs(filter.next(1.0));
  std::size_t quiet = 0;
  std::size_t k = 1;
  for (; k < kMaxSamples && quiet < 32; ++k) {
    const double v = std::abs(filter.next(0.0));
    total += v;
    quiet = v <= 1e-10 * total ? quiet + 1 : 0;
  }
  return k;
}

}  // namespace bodesmith::tracking
