#pragma once

#include <vector>

#include "fpaa/cams/placed_cam.hpp"

namespace bodesmith::fpaa {

class Cam;

/// CAM SumInv: the whole-period sum of 1 to 6 inputs, one op-amp. With D = 1 - 1/z, from input i:
///   H_i = -(Cin_i + aCin_i D)/(Cout + aCout D)
/// Cin and Cout are switched, aCin and aCout (always there: it keeps the op-amp's loop closed) are not.
/// aCin_i = Cin_i and aCout = Cout is the plain gain -Cin_i/Cout that AnadigmDesigner2 makes; without aCin an
/// input is a fast low pass (corner about fc Cout/aCout), with more of it the input leads, which makes up for
/// the hold behind. Charge balance of the switches of facts/an231.md, part 2 ("sum, whole period").
struct SumInvCapacitors {
  struct Input {
    int cin = 1;
    int acin = 0;
  };
  std::vector<Input> inputs;
  int cout = 1;
  int acout = 1;

  std::vector<Capacitor> named() const;
};

const Cam& sum_inv_cam();

}  // namespace bodesmith::fpaa
