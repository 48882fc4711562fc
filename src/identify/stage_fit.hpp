#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hysteresis/model_type.hpp"
#include "identify/stage_model.hpp"
#include "signal/statistics.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::identify {

/// Over several records: all samples together, the range of all of them. The first `skip_s` seconds of every
/// record are simulated but not counted (start transients).
ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s = 0.0);

using hysteresis::Identified;
using hysteresis::IdentifyOptions;

/// One model held against records: what identify reports.
struct StageFit {
  std::string model;
  Identified identified;
  StageModel stage;
  ErrorFigures training;
  std::optional<ErrorFigures> holdout;
  double compute_s = 0.0;
  /// Not empty: the model cannot be identified from these records, and why.
  std::string refused;
};

/// Everything that identify does: the delay first (from the play bank, which is cheap and general; see
/// best_delay()), then the type's own identification, then the errors over the counted samples.
struct StageFitOptions {
  IdentifyOptions identify;
  /// A number: that delay. Absent: looked for when `find_delay`, otherwise none.
  std::optional<double> delay_s;
  bool find_delay = false;
};
/// `model` null: the straight line without hysteresis, called "linear". Throws InputError when the records
/// cannot determine the model.
StageFit fit_stage(const hysteresis::ModelType* model, std::span<const TimeRecord> training,
                   std::span<const TimeRecord> holdout, const StageFitOptions& options);

/// The pure delay in [0, 8 samples] that leaves the smallest error to a bank of ten plays, by scan and golden
/// section; to a straight line when `linear`.
double best_delay(std::span<const TimeRecord> records, const IdentifyOptions& options, bool linear);

/// The record as a model without delay should see it: y advanced by the delay, the end cut off.
TimeRecord advanced(const TimeRecord& record, double delay_s);

/// y = offset + gain u, the model without hysteresis, as the ladder's lowest step.
Identified identify_linear(std::span<const TimeRecord> records, const IdentifyOptions& options);

}  // namespace bodesmith::identify
