#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "fpaa/network_cascade.hpp"
#include "fpaa/network_parallel.hpp"

namespace bodesmith::fpaa {

/// Clock over the pole of a high pass (in rad/s): within one capacitor ratio.
inline constexpr double kHighPassReach = 225.0;

/// A path for each real pole and each complex pair; real poles that lie near each other as one path of two.
std::vector<ParallelPath> paths_of(std::vector<std::complex<double>> poles, bool pair_near);

/// Poles below a corner, with as many of the lowest zeros, and the rest.
struct SplitRoots {
  NetworkRoots fast;
  std::vector<std::complex<double>> slow;
  std::size_t taken = 0;  ///< zeros
};
SplitRoots split_roots(const NetworkRoots& roots, RadPerSecond lowest);

/// Takes the lowest zeros out until `most` are taken (`taken` are already); pairs stay together.
std::size_t take_lowest_zeros(std::vector<std::complex<double>>& zeros, std::size_t taken, std::size_t most);

/// The lowest real pole that one ratio reaches at a clock that is fast enough for the band.
std::optional<RadPerSecond> high_pass_pole(const NetworkRoots& roots, Band band);

}  // namespace bodesmith::fpaa
