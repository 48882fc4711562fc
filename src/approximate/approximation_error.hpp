#pragma once

#include "lti/cascade.hpp"
#include "lti/sections.hpp"

namespace bodesmith {

/// Difference between sections and the fractional response they stand for.
struct ApproximationError {
  Band band;
  double band_db = 0.0;        ///< largest |magnitude error| over the band
  double band_deg = 0.0;       ///< largest |phase error| over the band
  double everywhere_db = 0.0;  ///< over all frequencies, 0 and infinity included
  double everywhere_deg = 0.0;
  Hertz worst;  ///< where everywhere_db is met (0 and infinity are given as the ends of the grid)

  /// As a sections file states it.
  Sections::Error summary() const { return {band, band_db, band_deg, everywhere_db}; }
};

/// Compares sections with a cascade over its corner band and everywhere. Sums logarithms of the single factors, so that
/// errors far below rounding of the whole product still show.
ApproximationError approximation_error(const Sections& sections, const Cascade& cascade);

}  // namespace bodesmith
