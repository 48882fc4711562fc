#pragma once

#include <cstdint>
#include <vector>

namespace bodesmith::yield {

/// Counts of one quantity in equal bins; `low` and `high` belong to the design, not to the samples, so that
/// counts from different processes add up.
struct Histogram {
  double low = 0.0, high = 1.0;
  std::vector<std::uint64_t> counts;
  double min = 0.0, max = 0.0;  ///< exact

  /// Linear within a bin.
  double quantile(double p) const;
};

}  // namespace bodesmith::yield
