#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "base/units.hpp"

namespace bodesmith::faults {

/// A response measured on a built board: from its input to one of its nodes.
struct Channel {
  std::string file;
  std::string node = "out";
  std::vector<Hertz> grid;          ///< rising
  std::vector<double> log_gain;     ///< ln |H|
  std::vector<double> phase_rad;    ///< empty: magnitude alone
  std::size_t measured_points = 0;  ///< in the file; `grid` may hold fewer
};

/// CSV with frequency_hz, magnitude_db or gain, and phase_deg in every row or in none. Of more than 121 points
/// points evenly chosen ones are kept. Errors with file and line.
Channel read_channel(const std::filesystem::path& path, const std::string& node, Provenance& from);

/// Everything that was measured on one board.
struct Measurement {
  std::vector<Channel> channels;
  std::size_t points() const;
};

/// Standard deviations of what was measured: of ln |H| and of the phase in rad.
struct Noise {
  double gain = 0.0;
  double phase = 0.0;
};

/// From how each value differs from the straight line (over log frequency) through its neighbours: `gain` and `phase`
/// are residuals one behind the other as in the measurement (phase empty: none). What is smooth over three points
/// does not count, nor do points within a factor of 5 of `floors`. Medians, so that single outliers do not count either.
Noise rough_noise(const Measurement& measured, const std::vector<double>& gain,
                  const std::vector<double>& phase, const std::vector<double>& floors);

}  // namespace bodesmith::faults
