#include "simulate/record_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

double loop_height_percent(std::span<const double> u, std::span<const double> y, int levels) {
  if (u.size() != y.size()) throw std::logic_error("a loop needs one output for each input");
  if (u.size() < 3 || levels < 1) return 0.0;
  const auto [low, high] = std::minmax_element(u.begin(), u.end());
  const auto [y_low, y_high] = std::minmax_element(y.begin(), y.end());
  if (!(*high > *low) || !(*y_high > *y_low)) return 0.0;
  double height = 0.0;
  for (int i = 1; i <= levels; ++i) {
    const double level = *low + (*high - *low) * i / (levels + 1);
    double most = -std::numeric_limits<double>::infinity();
    double least = std::numeric_limits<double>::infinity();
    bool rose = false;
    bool fell = false;
    for (std::size_t k = 1; k < u.size(); ++k) {
      const bool up = u[k - 1] < level && u[k] >= level;
      const bool down = u[k - 1] > level && u[k] <= level;
      if (!up && !down) continue;
      (up ? rose : fell) = true;
      const double at = y[k - 1] + (y[k] - y[k - 1]) * (level - u[k - 1]) / (u[k] - u[k - 1]);
      most = std::max(most, at);
      least = std::min(least, at);
    }
    if (rose && fell) height = std::max(height, most - least);
  }
  return 100.0 * height / (*y_high - *y_low);
}

}  // namespace bodesmith::simulate
