#pragma once

#include <complex>
#include <vector>

#include "base/units.hpp"

namespace bodesmith::part_errors {

struct Margin {
  double deg = 180.0;  ///< 180: |T| never is 1
  Hertz crossing;
};
/// Least phase margin of a return ratio T (1 + T is what must not vanish) over a rising grid.
Margin phase_margin(const std::vector<Hertz>& grid, const std::vector<std::complex<double>>& t);
/// By how much T may grow before it reaches -1 on the real axis; 0: it never would.
double gain_margin_db(const std::vector<std::complex<double>>& t);

}  // namespace bodesmith::part_errors
