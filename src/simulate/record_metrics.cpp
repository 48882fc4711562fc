#include "simulate/record_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace bodesmith::simulate {

RecordDifference compare_records(std::span<const double> simulated, std::span<const double> measured) {
  if (simulated.size() != measured.size() || measured.empty())
    throw std::logic_error("records of different length were compared");
  RecordDifference out;
  double sum = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double e = simulated[i] - measured[i];
    sum += e * e;
    out.max = std::max(out.max, std::abs(e));
  }
  out.rms = std::sqrt(sum / static_cast<double>(measured.size()));
  const auto [low, high] = std::minmax_element(measured.begin(), measured.end());
  if (*high > *low) out.rms_percent_of_range = 100.0 * out.rms / (*high - *low);
  return out;
}

}  // namespace bodesmith::simulate
