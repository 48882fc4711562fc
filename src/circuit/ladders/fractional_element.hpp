#pragma once

#include <complex>
#include <string>
#include <vector>

#include "base/outcome.hpp"
#include "circuit/ladders/rc_ladder.hpp"
#include "circuit/parts/series.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::circuit {

/// A constant-phase element, Z(s) = 1/(Q s^alpha) with 0 < alpha < 1 and Q in S s^alpha, as a passive RC
/// network: Oustaloup's alternating poles and zeros (CRONE, 1991) over a band give
///   Z(s) = (1/Q) wh^-alpha prod (s + wp_k)/(s + wz_k),   wz_k < wp_k: an RC impedance,
/// which is drawn in one of four ways (rc_ladder.hpp).
struct FractionalElement {
  double alpha = 0.5;
  double q = 1e-6;
  struct Part {
    bool resistor = true;
    std::string name, from, to;  ///< nodes: "a", "b" are the terminals
    double wanted = 0.0, realised = 0.0;
  };
  std::vector<Part> parts;
  Band band;

  /// With the realised parts.
  std::complex<double> impedance(RadPerSecond w) const;
  std::complex<double> ideal(RadPerSecond w) const;
  /// `.subckt NAME a b`, portable.
  std::string subcircuit(const std::string& name) const;
};

/// `order` RC pairs over `band`; the rational function itself reaches a decade further on both sides, so that
/// the phase holds (3 degrees off at the ends, 1 in the middle, for 8 pairs on two decades). Refused
/// for alpha outside (0, 1), q <= 0, order outside 1 to 12 or an empty band.
Outcome<FractionalElement> try_fractional_element(double alpha, double q, Band band, int order,
                                                  const RcLadder& ladder, const Series& resistors,
                                                  const Series& capacitors);
/// The same for the edge of the library: throws DesignError.
FractionalElement make_fractional_element(double alpha, double q, Band band, int order,
                                          const RcLadder& ladder, const Series& resistors,
                                          const Series& capacitors);

}  // namespace bodesmith::circuit
