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

/// A measured frequency response.
struct FrequencyRecord {
  std::string file;
  std::vector<Hertz> frequency;
  std::vector<Complex> response;
  std::vector<double> coherence;  ///< empty, or one value in [0, 1] a row

  /// CSV `frequency_hz,magnitude_db,phase_deg` (optional `coherence`); frequencies rising and above 0.
  static FrequencyRecord read_csv(const std::filesystem::path& path, Provenance& from);
};

}  // namespace bodesmith
