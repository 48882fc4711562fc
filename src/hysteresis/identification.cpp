#include "hysteresis/identification.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::hysteresis {
namespace {

struct Sum {
  double squares = 0.0;
  double largest = 0.0;
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  std::size_t count = 0;

  void add(const std::vector<double>& got, const std::vector<double>& wanted) {
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const double miss = got[i] - wanted[i];
      squares += miss * miss;
      largest = std::max(largest, std::abs(miss));
      low = std::min(low, wanted[i]);
      high = std::max(high, wanted[i]);
    }
    count += wanted.size();
  }

  ErrorFigures figures() const {
    ErrorFigures out;
    if (count == 0) return out;
    out.rms = std::sqrt(squares / static_cast<double>(count));
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
  sum.add(got, wanted);
  return sum.figures();
}

ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records) {
  Sum sum;
  for (const TimeRecord& record : records) sum.add(stage.simulate(record.u, record.step_s), record.y);
  return sum.figures();
}

}  // namespace bodesmith::hysteresis
