#include "hysteresis/identification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith::hysteresis {
namespace {

struct Sum {
  double squares = 0.0;
  double largest = 0.0;
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  double around_means = 0.0;
  std::size_t count = 0;

  void add(const std::vector<double>& got, const std::vector<double>& wanted, std::size_t first) {
    double sum = 0.0;
    double own = 0.0;
    for (std::size_t i = first; i < wanted.size(); ++i) {
      const double miss = got[i] - wanted[i];
      squares += miss * miss;
      sum += miss;
      own += miss * miss;
      largest = std::max(largest, std::abs(miss));
      low = std::min(low, wanted[i]);
      high = std::max(high, wanted[i]);
    }
    if (first < wanted.size())
      around_means += std::max(0.0, own - sum * sum / static_cast<double>(wanted.size() - first));
    count += wanted.size() - first;
  }

  ErrorFigures figures() const {
    ErrorFigures out;
    if (count == 0) return out;
    out.rms = std::sqrt(squares / static_cast<double>(count));
    out.rms_free_offset = std::sqrt(around_means / static_cast<double>(count));
    out.max = largest;
    out.range = high - low;
    if (out.range > 0.0) {
      out.rms_percent = 100.0 * out.rms / out.range;
      out.max_percent = 100.0 * out.max / out.range;
    }
    return out;
  }
};

}  // namespace

ErrorFigures error_figures(const std::vector<double>& got, const std::vector<double>& wanted) {
  Sum sum;
  sum.add(got, wanted, 0);
  return sum.figures();
}

std::size_t first_counted(const TimeRecord& record, double skip_s) {
  const double steps = std::ceil(skip_s / record.step_s - 1e-9);
  if (!(steps > 0.0)) return 0;
  return steps >= static_cast<double>(record.size()) ? record.size() - 1 : static_cast<std::size_t>(steps);
}

ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s) {
  Sum sum;
  for (const TimeRecord& record : records)
    sum.add(stage.simulate(record.u, record.step_s), record.y, first_counted(record, skip_s));
  return sum.figures();
}

}  // namespace bodesmith::hysteresis
