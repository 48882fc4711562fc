#pragma once

#include "base/units.hpp"
#include "fpaa/cams/cam_values.hpp"
#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

class Cam;

/// Corner frequency at which a branch C0 + C1 (1 - 1/z) turns: fc/pi atan(C0/(C0 + 2 C1)).
Hertz branch_corner(double c0, double c1, Hertz clock);

/// What the dialog of option "Pole and Zero" asks for: gain (1 + s/zero) / (1 + s/pole). (It takes one of the
/// gains and shows the other.)
struct PoleZeroSpec {
  Hertz pole;
  Hertz zero;
  double dc_gain = 1.0;
  double high_frequency_gain = 1.0;

  CamValues values() const;
  static PoleZeroSpec from(const CamValues& values);
};

/// What the dialogs of options "Low Pass" (gain at DC) and "High Pass" (gain at high frequency) ask for.
struct CornerSpec {
  Hertz corner;
  double gain = 1.0;

  CamValues values() const;
  static CornerSpec from(const CamValues& values);
};

/// CAM FilterBilinear, option "Pole and Zero": four capacitors, one op-amp,
///   H(z) = -(Ca + Cb (1 - 1/z)) / (Cc + Cd (1 - 1/z)).
/// With j tan(w/2fc) for s this is exactly -(Ca + s(Ca + 2Cb))/(Cc + s(Cc + 2Cd)): a bilinear image, so
///   tan(pi fz/fc) = Ca/(Ca + 2Cb),  tan(pi fp/fc) = Cc/(Cc + 2Cd),
///   DC gain -Ca/Cc,  gain at fc/2 -(Ca + 2Cb)/(Cc + 2Cd).
/// The topology is an assumption (the vendor does not publish it); every plan says so.
struct PoleZeroCapacitors {
  int ca = 1;
  int cb = 1;
  int cc = 1;
  int cd = 1;

  ZTransfer transfer() const;
  /// Corner frequencies of the bilinear image, by tan.
  Hertz zero(Hertz clock) const;
  Hertz pole(Hertz clock) const;
  double dc_gain() const { return static_cast<double>(ca) / cc; }
  double high_frequency_gain() const { return static_cast<double>(ca + 2 * cb) / (cc + 2 * cd); }
  PoleZeroSpec realised(Hertz clock) const;
};

/// CAM FilterBilinear, option "Low Pass": three capacitors, one op-amp,
///   H(z) = -Cin / (Cout + Cint (1 - 1/z)),
/// pole at tan(pi f0/fc) = Cout/(2 Cint + Cout), DC gain -Cin/Cout. Its zero lies at z = 0, not at z = -1.
struct LowPassCapacitors {
  int cin = 1;
  int cint = 1;
  int cout = 1;

  ZTransfer transfer() const;
  Hertz corner(Hertz clock) const;
  double gain() const { return static_cast<double>(cin) / cout; }
};

/// CAM FilterBilinear, option "High Pass": three capacitors, one op-amp. Assumed to be the pole-zero form
/// without its Ca branch, H(z) = -Cb (1 - 1/z) / (Cc + Cd (1 - 1/z)); gain at fc/2 is -2Cb/(Cc + 2Cd).
struct HighPassCapacitors {
  int cb = 1;
  int cc = 1;
  int cd = 1;

  ZTransfer transfer() const;
  Hertz corner(Hertz clock) const;
  double gain() const { return 2.0 * cb / (cc + 2 * cd); }
};

const Cam& filter_bilinear_cam();

}  // namespace bodesmith::fpaa
