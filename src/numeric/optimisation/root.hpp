#pragma once

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>

namespace bodesmith {

/// Where f is zero between low and high, to the last bits (Alefeld, Potra and Shi, TOMS 748); where both ends have the same sign,
/// the end at which f is nearer to zero.
template <class F>
double root_between(const F& f, double low, double f_low, double high, double f_high) {
  if (f_low == 0.0 || f_high == 0.0 || (f_low < 0.0) == (f_high < 0.0))
    return std::abs(f_low) <= std::abs(f_high) ? low : high;
  std::uintmax_t most = 200;
  const auto [a, b] = boost::math::tools::toms748_solve(f, low, high, f_low, f_high,
                                                        boost::math::tools::eps_tolerance<double>(), most);
  return std::abs(f(a)) <= std::abs(f(b)) ? a : b;
}
template <class F>
double root_between(const F& f, double low, double high) {
  return root_between(f, low, f(low), high, f(high));
}

}  // namespace bodesmith
