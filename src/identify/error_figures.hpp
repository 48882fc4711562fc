#pragma once

#include <span>
#include <vector>

#include "identify/stage_model.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::identify {

/// How far a model's output is from a record's (disturbance paper, eq. 8; the percentages are of the record's own
/// range).
struct ErrorFigures {
  double rms = 0.0;
  double max = 0.0;
  double range = 0.0;
  double rms_percent = 0.0;
  double max_percent = 0.0;
  /// RMS with every record's own mean error taken out: a sensor's zero that moves between records is not the
  /// model's.
  double rms_free_offset = 0.0;
};
ErrorFigures error_figures(const std::vector<double>& got, const std::vector<double>& reference);
/// Over several records: all samples together, the range of all of them. The first `skip_s` seconds of every
/// record are simulated but not counted (start transients).
ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s = 0.0);

}  // namespace bodesmith::identify
