#pragma once

#include <vector>

#include "fpaa/cams/placed_cam.hpp"
#include "fpaa/cams/switches.hpp"
#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

class Cam;

/// A two-op-amp stage of this program's own: the FilterBiquad's two integrators with all three inputs at
/// once, so that any second-order numerator over any second-order denominator is one CAB. One bank each, 8
/// capacitors at most. With D = 1 - 1/z:
///
///   low Q:   -(+-C1 C3/z + Cp CA D   + Cpp CA D^2) / (CA D (CB D + C4) + C2 C3/z)
///   high Q:  -(+-C1 C3/z + Cp C3 D/z + Cpp CA D^2) / (CA CB D^2 + C3/z (C2 + C4 D))
///
/// C1 switched into the first op-amp, inverting (+, in phase 1) or not (-, taken in phase 1, given in phase
/// 2: the second integrator reads the first in phase 2, so that both signs come one period later); C2 from the
/// output to the first op-amp; C3 from the first to the second, read one period late; low Q: C4 and Cp
/// switched into the second, high Q: both static into the first; Cpp static into the second; CA, CB feedback.
/// Derived by charge balance from the vendor's band-pass biquad (facts/an231.md, part 2). With real poles far
/// apart it is the first-order low pass of a clock that is 65025 times its corner: C2 C3/(CA C4).
struct BiquadStageCapacitors {
  bool high_q = false;
  bool c1_inverting = true;
  double c1 = 0.0, cp = 0.0, cpp = 0.0;
  double c2 = 1.0, c3 = 1.0, c4 = 1.0, ca = 1.0, cb = 1.0;

  /// Of capacitors named as above; what is not there is 0.
  static BiquadStageCapacitors from(const CapacitorUnits& c, bool high_q, bool c1_inverting);
  DeltaTransfer transfer() const;
  /// fc/2pi sqrt(C2 C3/(CA CB)) by LDI (sin, not tan): w0 = 2 fc sin(pi f0/fc).
  Hertz corner(Hertz clock) const;
  /// Low Q: CB (w0/fc)/C4; high Q: sqrt(CA CB C2/C3)/C4.
  double quality() const;
  /// Of one input: C1/C2 at DC (low pass), Cp/C4 at the centre (band pass), Cpp/CB far above (high pass).
  double gain() const;
  /// In the vendor's order for its band pass; what is not there takes no capacitor. `banks`: CA and CB of two banks each.
  StageSwitches switches(bool banks) const;
};

/// The words in PlacedCam::option, from which `transfer` takes the form: "Low Q", "Low Q, C1 non-inverting".
std::string biquad_stage_option(bool high_q, bool c1_inverting);

const Cam& biquad_stage_cam();

}  // namespace bodesmith::fpaa
