#pragma once

#include <complex>
#include <filesystem>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "base/units.hpp"

namespace bodesmith {

/// A measured frequency response.
struct FrequencyRecord {
  std::string file;
  std::vector<Hertz> frequency;
  std::vector<std::complex<double>> response;
  std::vector<double> coherence;  ///< empty, or one value in [0, 1] a row

  /// CSV `frequency_hz,magnitude_db,phase_deg` (optional `coherence`); frequencies rising and above 0.
  static FrequencyRecord read_csv(const std::filesystem::path& path, Provenance& from);
};

}  // namespace bodesmith
