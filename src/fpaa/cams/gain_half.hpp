#pragma once

#include "fpaa/cams/z_transfer.hpp"

namespace bodesmith::fpaa {

/// CAM GainHalf: gain Cin/Cout of either sign, valid during one phase and at ground during the other (its
/// mean is half); two capacitors, one op-amp. The non-inverting one is half a cycle late.
struct GainHalf {
  int cin = 1;
  int cout = 1;
  bool inverting = true;

  ZTransfer transfer() const { return {{(inverting ? -1.0 : 1.0) * cin}, {static_cast<double>(cout)}}; }
  double gain() const { return static_cast<double>(cin) / cout; }
  double delay_cycles() const { return inverting ? 0.0 : 0.5; }
  /// Vendor limit: (1 + G) fc <= 19.68 MHz.
  Hertz fastest_clock() const { return {19.68e6 / (1.0 + gain())}; }
};

}  // namespace bodesmith::fpaa
