#pragma once

#include <complex>

#include "base/units.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::fpaa {

/// One switched branch of a CAM, C0 + C1 (1 - 1/z), above or below the fraction line, and what it stands for.
struct Branch {
  enum class Kind {
    corner,           ///< imitates 1 + s/corner; C0 and C1 from 1
    constant,         ///< imitates 1; C1 = 0
    differentiating,  ///< imitates s (in rad/s); C0 = 0
  };
  Kind kind = Kind::corner;
  RadPerSecond corner;  ///< for Kind::corner
  bool above = true;    ///< numerator
  std::size_t cam = 0;  ///< the CAM it belongs to, counted along the signal path

  /// What it imitates, at jw.
  std::complex<double> imitated(RadPerSecond w) const;
};

/// Capacitors of a branch, in unit capacitances.
struct BranchValue {
  int c0 = 0;
  int c1 = 0;
};

/// Corner at which a branch C0 + C1 (1 - 1/z) turns: fc/pi atan(C0/(C0 + 2 C1)).
Hertz branch_corner(double c0, double c1, Hertz clock);
/// The ratio C1/C0 that puts the corner of a branch exactly (by tan) at `corner`: (1/tan(pi f/fc) - 1)/2.
/// Negative above fc/4, where no branch of positive capacitors turns.
double branch_ratio(Hertz corner, Hertz clock);

/// Whether a branch can reach its corner at this clock with capacitors up to `max_capacitor` (within half a
/// unit).
bool is_reachable(const Branch& branch, Hertz clock, int max_capacitor);
/// The clocks at which a branch can have this corner.
Band clocks_for_corner(RadPerSecond corner, int max_capacitor);

}  // namespace bodesmith::fpaa
