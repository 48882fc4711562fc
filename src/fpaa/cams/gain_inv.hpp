#pragma once

#include "fpaa/z_transfer.hpp"

namespace bodesmith::fpaa {

/// CAM GainInv: H = -Cin/Cout, valid during the full cycle; four capacitors (the two that set the gain are
/// named Cin and Cout), one op-amp.
struct GainInvCapacitors {
  int cin = 1;
  int cout = 1;

  ZTransfer transfer() const { return {{-static_cast<double>(cin)}, {static_cast<double>(cout)}}; }
  double gain() const { return static_cast<double>(cin) / cout; }
};

}  // namespace bodesmith::fpaa
