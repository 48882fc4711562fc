#pragma once

#include <span>

namespace bodesmith::simulate {

/// How far a simulated output is from a measured one, over all samples (signal/error_figures.hpp).
struct RecordDifference {
  double rms = 0.0;
  double max = 0.0;
  double rms_percent_of_range = 0.0;  ///< of the measured output's range; 0 for a range of 0
};

/// Both of one length above 0.
RecordDifference compare_records(std::span<const double> simulated, std::span<const double> measured);

}  // namespace bodesmith::simulate
