#pragma once

#include <Eigen/Dense>
#include <limits>
#include <span>
#include <vector>

#include "base/progress.hpp"
#include "hysteresis/identification.hpp"
#include "hysteresis/operator.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    low = value < low ? value : low;
    high = value > high ? value : high;
  }
  double width() const { return high - low; }
  double middle() const { return 0.5 * (low + high); }
};

/// Over the counted samples of all records.
Range input_range(std::span<const TimeRecord> records, double skip_s);
Range output_range(std::span<const TimeRecord> records, double skip_s);
std::size_t counted_samples(std::span<const TimeRecord> records, double skip_s);

/// Model minus record for every counted sample; every record starts at rest under its first input.
void operator_residual(const Operator& op, std::span<const TimeRecord> records, double skip_s,
                       Eigen::VectorXd& residual);

/// A branch of a record: samples first … last over which the input moves one way only.
struct Branch {
  std::size_t first = 0;
  std::size_t last = 0;
  bool rising = true;
};
/// Cuts at the turning points of the input; moves smaller than `dead` times the input's range do not count as
/// turns.
std::vector<Branch> branches(const std::vector<double>& u, double dead = 1e-3);

}  // namespace bodesmith::hysteresis
