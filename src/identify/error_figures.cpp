#include "identify/error_figures.hpp"

#include "hysteresis/record_tools.hpp"

namespace bodesmith::identify {

ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s) {
  ErrorSum sum;
  for (const TimeRecord& record : records)
    sum.add(stage.simulate(record.u, record.step_s), record.y, hysteresis::first_counted(record, skip_s));
  return sum.figures();
}

}  // namespace bodesmith::identify
