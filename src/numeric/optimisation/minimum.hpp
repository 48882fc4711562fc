#pragma once

#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "base/whole_number.hpp"

namespace bodesmith {

/// Where a function of one number with one minimum between `low` and `high` is least, within `tolerance` (or the root of
/// the type's precision times the interval, which is all that values of the function can tell), by Brent's parabolas
/// and golden sections.
template <class Real, class Cost>
Real minimum_between(Real low, Real high, Real tolerance, Cost&& cost) {
  const Real width = high - low;
  if (!(width > tolerance)) return low + width / 2;
  // Boost's tolerance is relative to the place: on the unit interval it is one of the interval.
  const int bits = 2 - nearest_whole<int>(std::floor(std::log2(static_cast<double>(tolerance / width))));
  const auto at = [&](Real t) { return cost(low + width * t); };
  return low + width * boost::math::tools::brent_find_minima(at, Real(0), Real(1), bits).first;
}

}  // namespace bodesmith
