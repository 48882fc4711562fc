#pragma once

#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

/// CAM Integrator: -(Cin/Cint)/(1 - 1/z), or (Cin/Cint) z^-1/(1 - 1/z) when it does not invert; constant
/// fc Cin/Cint per second. Two capacitors, one op-amp.
struct Integrator {
  int cin = 1;
  int cint = 1;
  bool inverting = true;

  ZTransfer transfer() const {
    const double a = static_cast<double>(cint);
    if (inverting) return {{-static_cast<double>(cin)}, {a, -a}};
    return {{0.0, static_cast<double>(cin)}, {a, -a}};
  }
  double constant_per_s(Hertz clock) const { return clock.value * cin / cint; }
};

}  // namespace bodesmith::fpaa
