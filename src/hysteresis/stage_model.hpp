#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hysteresis/inverse.hpp"
#include "hysteresis/model.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

/// A hysteresis model between two scalings, as identify returns it and model.toml holds it (blocks in
/// series):
///   y(t) = output_offset + output_gain · H[input_offset + input_gain · u](t − delay).
struct StageModel {
  double delay_s = 0.0;
  double input_gain = 1.0;
  double input_offset = 0.0;
  Model model;
  double output_gain = 1.0;
  double output_offset = 0.0;

  /// The output for every sample, starting at rest under the first input. The input is linear between
  /// samples.
  std::vector<double> simulate(const std::vector<double>& u, double step_s) const;
  /// The whole model.toml, with a comment line per entry of `remarks`.
  std::string to_toml(const std::vector<std::string>& remarks = {}) const;
};

/// Reads a model.toml whose blocks are gain, delay and at most one hysteresis model, in any order; throws
/// InputError naming the block that is something else.
StageModel stage_model_from_node(const Node& document);

/// The drive that makes the stage follow a reference, and how well it can.
struct Compensation {
  std::vector<double> drive;
  std::vector<double> predicted;  ///< the model's output under the drive, delay included
  std::size_t out_of_reach = 0;   ///< samples whose wanted output the model cannot reach
};
/// Inverts the static and hysteretic parts exactly. A delay is made good by looking ahead in the reference
/// when `preview` is set, otherwise it stays in the predicted output.
Compensation compensate(const StageModel& stage, const std::vector<double>& reference, double step_s,
                        bool preview);

/// The input of a sampled signal delayed by a time that need not be a multiple of the step (linear between
/// samples; before the first sample its value).
std::vector<double> delayed(const std::vector<double>& u, double step_s, double delay_s);

}  // namespace bodesmith::hysteresis
