#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "fpaa/device/mismatch.hpp"

namespace bodesmith::fpaa {

/// Whole capacitors of a board whose capacitors are known (more or less), by a linear prediction of its error.
struct TrimProblem {
  std::vector<int> built;                                ///< units as the board was measured
  std::vector<double> excess;                            ///< what each has too much, in units (estimated)
  std::vector<int> units;                                ///< where error and slope are those of
  std::vector<std::complex<double>> error;               ///< got/wanted - 1, at each frequency
  std::vector<std::vector<std::complex<double>>> slope;  ///< d error / d ln C: [capacitor][frequency]
  double unit_variance = 0.0;                            ///< k^2
  double systematic_units = 0.0;                         ///< in every capacitor, whatever its size
  UnitArray array = UnitArray::binary;
  double reach = 0.25;  ///< how far a capacitor may go from `units`, relative: the prediction is linear
  std::uint64_t seed = 1;

  /// A capacitor that was built as so many units, and what it has too much, when it has `to` of them.
  struct Exchanged {
    double units = 0.0;  ///< expected
    double variance = 0.0;
  };
  Exchanged exchanged(int from, double more, int to) const;
};

/// Standard deviations of what exchanged units add that count as error.
inline constexpr double kCountedDeviations = 2.0;

/// The best found. Far more sets of whole capacitors lie near the built ones than can be tried, and the
/// response has few degrees of freedom, so that among them are some whose roundings cancel:
/// real least squares, the coarsest capacitor rounded (to a random neighbour after the first time), the others
/// solved again, and so on, twelve times; from each the best exchange of one capacitor's units, or of two, as long as
/// there is one. `kCountedDeviations` of what exchanged units add belong to the error. Same seed, same capacitors.
std::vector<int> search_trim(const TrimProblem& problem);

}  // namespace bodesmith::fpaa
