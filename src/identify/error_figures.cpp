#include "identify/error_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hysteresis/record_tools.hpp"

namespace bodesmith::identify {
namespace {

struct ErrorSum {
  double squares = 0.0;
  double max = 0.0;
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  double around_means = 0.0;
  std::size_t count = 0;

  void add(const std::vector<double>& got, const std::vector<double>& reference, std::size_t first) {
    double sum = 0.0;
    double own = 0.0;
    for (std::size_t i = first; i < reference.size(); ++i) {
      const double error = got[i] - reference[i];
      squares += error * error;
      sum += error;
      own += error * error;
      max = std::max(max, std::abs(error));
      low = std::min(low, reference[i]);
      high = std::max(high, reference[i]);
    }
    if (first < reference.size())
      around_means += std::max(0.0, own - sum * sum / static_cast<double>(reference.size() - first));
    count += reference.size() - first;
  }

  ErrorFigures figures() const {
    ErrorFigures out;
    if (count == 0) return out;
    out.rms = std::sqrt(squares / static_cast<double>(count));
    out.rms_free_offset = std::sqrt(around_means / static_cast<double>(count));
    out.max = max;
    out.range = high - low;
    if (out.range > 0.0) {
      out.rms_percent = 100.0 * out.rms / out.range;
      out.max_percent = 100.0 * out.max / out.range;
    }
    return out;
  }
};

}  // namespace

ErrorFigures error_figures(const std::vector<double>& got, const std::vector<double>& reference) {
  ErrorSum sum;
  sum.add(got, reference, 0);
  return sum.figures();
}

ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s) {
  ErrorSum sum;
  for (const TimeRecord& record : records)
    sum.add(stage.simulate(record.u, record.step_s), record.y, hysteresis::first_counted(record, skip_s));
  return sum.figures();
}

}  // namespace bodesmith::identify
