#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "signal/bode_points.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::gap {

/// A stretch, or an offset, is told of that holds this part of a gap.
constexpr double kMostOfGap = 0.5;

/// Steps of each axis; those of frequency are apart by one part in so many.
constexpr std::size_t kBins = 20;

/// What a gap is spread over.
enum class Axis {
  frequency,  ///< of the residual's spectrum, Hz
  input,      ///< its amplitude
  output,     ///< the measured one's amplitude
  time,       ///< of the record, s
  branch,     ///< 1: input rising, -1: falling, 0: at rest
  harmonic,   ///< of the input's period (only for periodic inputs)
};
struct AxisWords {
  const char* name;     ///< as in diagnosis.json
  const char* heading;  ///< of a table
  const char* stretch;  ///< {}: of it
};
const AxisWords& words_of(Axis axis);

/// A stretch of an axis and the share of the gap (mean square of the residual) that lies in it.
struct Cell {
  Axis axis = Axis::time;
  double from = 0.0;
  double to = 0.0;
  double share = 0.0;
  double extent = 0.0;  ///< share of the record (samples, or band) that the stretch covers
};

/// A step of an axis, the gap's energy in it and how wide it is.
struct Bin {
  double from = 0.0;
  double to = 0.0;
  double energy = 0.0;
  double extent = 0.0;
};
using Bins = std::vector<Bin>;
/// Narrow logarithmic steps of frequency: mean square and width in Hz.
Bins frequency_bins(const std::vector<double>& e, double step_s);

/// For each axis the stretch in which the gap is densest (largest share minus extent), kept when it holds at
/// least half of the gap; largest share first. Axes on which the gap is spread evenly are left out, unless
/// all are.
std::vector<Cell> where(const TimeRecord& record, const std::vector<double>& residual, std::size_t from,
                        std::size_t period);
std::vector<Cell> where(const FrequencyRecord& record, const std::vector<double>& residual);

/// A cell in words: "frequencies 40 to 60 Hz (71 % of it)".
std::string to_text(const Cell& cell);

}  // namespace bodesmith::gap
