#pragma once

#include <span>

#include "signal/time_record.hpp"

namespace bodesmith {

/// How far a signal goes: what a model fitted to it has seen.
struct SignalExtent {
  double lower = 0.0;
  double upper = 0.0;
  double max_rate_per_s = 0.0;  ///< fastest change from sample to sample
  /// The band with all but a thousandth of the signal's variance, half of that below it and half above.
  double from_hz = 0.0;
  double to_hz = 0.0;
};
/// Of u of all records together, each without its first `skip_s` seconds.
SignalExtent input_extent(std::span<const TimeRecord> records, double skip_s = 0.0);

}  // namespace bodesmith
