#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "fpaa/network.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// Zeros and poles of a whole design, rad/s, conjugates in pairs next to each other.
struct NetworkRoots {
  std::vector<std::complex<double>> zeros;
  std::vector<std::complex<double>> poles;
};
NetworkRoots roots_of(const Sections& sections);

struct CascadeOptions {
  std::int64_t divisor = 16;  ///< the one clock, of the master clock
  int leads = 0;              ///< gain stages at the end that lead by half a period and turn the sign
};

/// Stages in a row at one clock, capacitors not yet whole, each root where z = exp(s T) puts it: first-order
/// stages for real poles, BiquadStages for complex ones, for complex or right-half-plane zeros, and for corners
/// that one capacitor ratio does not reach (a low real pole with a high one: two ratios). Ordered and scaled so
/// that the peaks of the nodes climb evenly to the output's. Nothing when some root has no stage that makes it.
std::optional<Network> cascade_network(const NetworkRoots& roots, const NetworkResponse& response,
                                       const CascadeOptions& options);

/// The corner below which one capacitor ratio at this clock does not reach, rad/s.
double lowest_one_ratio_corner(std::int64_t divisor, const NetworkTarget& target);

}  // namespace bodesmith::fpaa
