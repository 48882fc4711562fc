#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gap/model/model.hpp"
#include "gap/records/directions.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// Sines of these frequencies over samples `from` … `end` - 1 of a record, t as in its time_s (above half the sampling rate what sampling makes
/// of them). Sizes and phases of mains hum differ from record to record, and are therefore no
/// unknowns of a fit but taken out of every residual (the frequencies stay unknowns; variable projection, Golub and Pereyra 1973).
Directions directions_of_lines(std::span<const double> frequencies_hz, const TimeRecord& record,
                               std::size_t from, std::size_t end);

/// A line's size and phase: amplitude sin(2 pi frequency_hz t + phase_deg).
struct FittedLine {
  double amplitude = 0.0;
  double phase_deg = 0.0;
};
/// Least squares of a residual (measured - model) over samples `from` … of the record.
std::vector<FittedLine> fit_lines(std::span<const double> frequencies_hz, const TimeRecord& record,
                                  std::size_t from, std::span<const double> residual);

}  // namespace bodesmith::gap
