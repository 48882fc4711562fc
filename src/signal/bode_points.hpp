#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "base/units.hpp"

namespace bodesmith {

/// A wanted (or measured) point of a Bode plot.
struct BodePoint {
  Hertz frequency;
  double gain = 1.0;                ///< linear magnitude, > 0
  std::optional<double> phase_deg;  ///< where the file has the column
  double weight = 1.0;              ///< >= 0
  int line = 0;                     ///< in the file it came from; 0 when it did not come from one
};

/// Points with rising frequency.
struct BodePoints {
  std::string file;
  std::vector<BodePoint> points;

  /// CSV with `frequency_hz` and `gain` (linear) or `magnitude_db`; optional `phase_deg`, `weight`.
  /// Sorts by frequency. Errors (with line): a frequency or gain that is not above 0, the same frequency
  /// twice, a negative weight.
  static BodePoints read_csv(const std::filesystem::path& path, Provenance& from);
};

/// A measured frequency response with what may be known of how it was taken.
struct FrequencyRecord {
  std::string file;
  std::vector<Hertz> frequency;
  std::vector<Complex> response;
  // Empty, or one value a row:
  std::vector<double> coherence = {};  ///< in [0, 1]
  std::vector<double> averages = {};   ///< over how many measurements the coherence was taken
  std::vector<double> drive_v = {};    ///< the input's amplitude

  /// CSV `frequency_hz,magnitude_db,phase_deg` (optional `coherence`, `averages` of 1 or more, `drive_v` above 0); frequencies rising and
  /// above 0.
  static FrequencyRecord read_csv(const std::filesystem::path& path, Provenance& from);

  /// Every `stride`-th point from number `first` on, with all of its columns.
  FrequencyRecord thinned(std::size_t first, std::size_t stride) const;
};

}  // namespace bodesmith
