#pragma once

#include <vector>

#include "circuit/layout.hpp"

namespace bodesmith {

/// disturbance.sub in ngspice against the polynomials.
struct LayoutCheck {
  double static_percent =
      0.0;  ///< greatest |d - wanted| over x in [0, 1], both branches, percent of the range of x
  double static_against_program = 0.0;  ///< the same against the program's own figures
  struct Dynamic {
    Hertz frequency;
    double rms_percent = 0.0;  ///< second period of a triangle, slope detector and switch included
    double late_share = 0.0;   ///< share of the period in which the branch is the wrong one
  };
  std::vector<Dynamic> dynamic;
};

/// Static sweep, and a triangle of 0 to 1 V at each frequency through the slope detector. Needs ngspice.
LayoutCheck check_layout_with_ngspice(const DisturbanceLayout& layout, const std::vector<Hertz>& triangles);

}  // namespace bodesmith
