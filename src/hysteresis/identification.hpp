#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hysteresis/stage_model.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

/// How far a model's output is from a record's (first seed, eq. 8; the percentages are of the record's own
/// range).
struct ErrorFigures {
  double rms = 0.0;
  double max = 0.0;
  double range = 0.0;
  double rms_percent = 0.0;
  double max_percent = 0.0;
  /// RMS with every record's own mean miss taken out: a sensor's zero that moves between records is not the
  /// model's.
  double rms_free_offset = 0.0;
};
ErrorFigures error_figures(const std::vector<double>& got, const std::vector<double>& wanted);
/// Over several records: all samples together, the range of all of them. The first `skip_s` seconds of every
/// record are simulated but not counted (start transients).
ErrorFigures error_figures(const StageModel& stage, std::span<const TimeRecord> records, double skip_s = 0.0);
/// Index of the first counted sample.
std::size_t first_counted(const TimeRecord& record, double skip_s);

struct IdentifyOptions {
  std::uint64_t seed = 1;
  /// `best` (the better method, default) or `paper` (what the paper does).
  std::string method = "best";
  /// Size of the model where it has one: plays, exponential operators, Preisach or KP levels. 0: the type's
  /// default.
  int size = 0;
  /// Operating frequency where the model asks for it; 0: taken from the record.
  double frequency_hz = 0.0;
  /// Seconds at the start of every record that are simulated but not fitted.
  double skip_s = 0.0;
  /// Ask for the asymmetric form where the type has one (Prandtl-Ishlinskii: dead zones behind the plays).
  bool asymmetric = false;
  /// Effort of a stochastic search, relative to its default.
  double effort = 1.0;
};

/// A parameter with its standard deviation, from the residual's Jacobian at the solution, widened for the
/// residual's own correlation (effective sample size).
struct ParameterUncertainty {
  std::string name;  ///< e.g. "w[3]"
  double value = 0.0;
  double standard_deviation = 0.0;
};

struct Identified {
  StageModel stage;
  std::string method;  ///< in words
  std::vector<ParameterUncertainty> uncertainty;
  std::vector<std::string> notes;  ///< what a person must know (not identifiable, limits met)
  bool converged = true;
  double compute_s = 0.0;
};

}  // namespace bodesmith::hysteresis
