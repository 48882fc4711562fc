#pragma once

#include <cmath>

namespace bodesmith {

/// Where a function of one number with one minimum between `low` and `high` is least, within `tolerance`, by golden
/// sections (Kiefer, Proc. Am. Math. Soc. 4 (1953) 502): one evaluation of `cost` a step, each of which leaves 0.618
/// of the interval.
template <class Real, class Cost>
Real golden_section_minimum(Real low, Real high, Real tolerance, Cost&& cost) {
  const Real ratio = Real(0.5) * (std::sqrt(Real(5)) - Real(1));
  Real a = high - ratio * (high - low);
  Real b = low + ratio * (high - low);
  Real at_a = cost(a);
  Real at_b = cost(b);
  while (high - low > tolerance) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - ratio * (high - low);
      at_a = cost(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + ratio * (high - low);
      at_b = cost(b);
    }
  }
  return Real(0.5) * (low + high);
}

}  // namespace bodesmith
