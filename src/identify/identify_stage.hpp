#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hysteresis/identification.hpp"

namespace bodesmith::hysteresis {

/// One model held against records: what identify reports.
struct StageFit {
  std::string model;
  Identified identified;
  ErrorFigures training;
  std::optional<ErrorFigures> holdout;
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
StageFit fit_stage(const std::string& model, std::span<const TimeRecord> training,
                   std::span<const TimeRecord> holdout, const StageFitOptions& options);

/// The pure delay in [0, 8 samples] that leaves the least to a bank of ten plays, by scan and golden section;
/// with a linear model when `linear`.
double best_delay(std::span<const TimeRecord> records, const IdentifyOptions& options, bool linear);

/// The record as a model without delay should see it: y advanced by the delay, the end cut off.
TimeRecord advanced(const TimeRecord& record, double delay_s);

/// y = offset + gain u, the model without hysteresis, as the ladder's lowest step.
Identified identify_linear(std::span<const TimeRecord> records, const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
