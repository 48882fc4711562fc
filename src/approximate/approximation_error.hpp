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

/// The smallest possible error, in dB, of any stable real rational approximation with n poles of
/// ((s/a + 1)/(s/b + 1))^beta over all frequencies, kappa = b/a > 1, K = complete elliptic integral
/// (modulus):
///   E = (40/ln 10) |sin pi beta| |Gamma(n+1+beta) Gamma(n+1-beta)| / (Gamma(n+1/2) Gamma(n+3/2))
///       * exp(-pi (2n+1) K(1/kappa) / K(sqrt(1 - kappa^-2))).
/// Asymptotic in n: within 0.4 % of the true minimax where E < 0.1 dB, up to 9 % too low above 1 dB.
/// 0 for a whole beta with |beta| <= n. Meaningful for |beta| < n + 1; throws std::domain_error otherwise or
/// when kappa <= 1 or n < 0.
double minimax_limit_db(double kappa, double beta, int n);

/// Smallest n <= max_order whose law is at or below max_db; max_order + 1 when there is none.
int minimax_order(double kappa, double beta, double max_db, int max_order);

}  // namespace bodesmith
