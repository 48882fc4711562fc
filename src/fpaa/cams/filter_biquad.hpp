#pragma once

#include <vector>

#include "base/units.hpp"
#include "fpaa/cams/cam_values.hpp"
#include "fpaa/cams/placed_cam.hpp"
#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

/// What the dialog asks for.
struct BiquadSpec {
  Hertz corner;
  double quality = 1.0;
  double gain = 1.0;  ///< at DC (low pass), at the centre (band pass), at high frequency (high pass)

  CamValues values() const;
  static BiquadSpec from(const CamValues& values);
};

/// CAM FilterBiquad: two integrators in a loop (CA first, CB second), 8 capacitors, 2 op-amps; CA and CB are
/// each split over two banks (up to 510 units). With D = 1 - 1/z:
///
///   low Q:   denominator CA D (CB D + C4) + C2 C3/z     (C4 switched, across the second integrator)
///   high Q:  denominator CA CB D^2 + C3/z (C2 + C4 D)   (C4 unswitched, from the output to the first)
///   Low Pass   numerator -C1 C3/z                                      gain C1/C2 at DC
///   Band Pass  numerator -Cp CA D (low Q), -Cp C3 D/z (high Q)         gain Cp/C4 at the centre
///   High Pass  numerator -Cpp CA D^2                                   gain Cpp/CB far above the corner
///
/// f0 = fc/2pi sqrt(C2 C3/(CA CB)) by LDI (sin, not tan): w0 = 2 fc sin(pi f0/fc). Low Q: Q = CB (w0/fc)/C4;
/// high Q: Q = sqrt(CA CB C2/C3)/C4. The low-pass form is derived from vendor code; band and high pass are
/// the standard circuit that has the vendor's gains (assumed). The pole-and-zero form is not publicly known.
struct BiquadCapacitors {
  enum class Kind { low_pass, band_pass, high_pass };
  Kind kind = Kind::low_pass;
  bool high_q = false;
  int input = 1;  ///< C1, Cp or Cpp
  int c2 = 1, c3 = 1, c4 = 1, ca = 1, cb = 1;

  ZTransfer transfer() const;
  Hertz corner(Hertz clock) const;
  double quality() const;
  double gain() const;
};

}  // namespace bodesmith::fpaa
