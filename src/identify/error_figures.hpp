#pragma once

#include <span>

#include "identify/stage_model.hpp"
#include "signal/error_figures.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::identify {

/// Over several records: all samples together, the range of all of them. The first `skip_s` seconds of every
/// record are simulated but not counted (start transients).
ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s = 0.0);

}  // namespace bodesmith::identify
