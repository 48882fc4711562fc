#pragma once

#include <cstddef>
#include <vector>

#include "tracking/compensator.hpp"

namespace bodesmith::tracking {

/// A switched-capacitor chain, one sample after the other (transposed direct form II).
class SampledFilter {
 public:
  explicit SampledFilter(const ClockedCompensator& compensator);
  double next(double u);

 private:
  struct Section {
    std::vector<double> b, a, state;
  };
  double gain_;
  std::vector<Section> sections_;
};

/// Samples until the chain has forgotten its start: its impulse response has stayed below 1e-10 of its sum
/// for 32 samples; at most two million.
std::size_t memory_samples(const ClockedCompensator& compensator);

}  // namespace bodesmith::tracking
