#pragma once

#include "fpaa/z_transfer.hpp"

namespace bodesmith::fpaa {

/// CAM SumFilter, assumed to be the FilterBilinear low pass with two input branches:
///   Vout = -(C1 V1 + C2 V2)/(Cout + Cint (1 - 1/z)). Four capacitors, one op-amp.
struct SumFilter {
  int c1 = 1;
  int c2 = 1;
  int cint = 1;
  int cout = 1;

  ZTransfer transfer(int input) const {
    return {{-static_cast<double>(input == 1 ? c1 : c2)},
            {static_cast<double>(cout + cint), -static_cast<double>(cint)}};
  }
};

}  // namespace bodesmith::fpaa
