#pragma once

#include <optional>

namespace bodesmith::gap {

/// What the drive of experiment.csv may be, as far as somebody says it; the rest is taken from the training records.
struct DriveRequest {
  std::optional<double> lower;
  std::optional<double> upper;
  std::optional<double> max_rate;  ///< per second
  std::optional<double> duration_s;
  std::optional<double> step_s;

  static constexpr double kMostSamples = 20000.0;
};

}  // namespace bodesmith::gap
