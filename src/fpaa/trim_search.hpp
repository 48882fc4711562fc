#pragma once

#include <complex>
#include <vector>

namespace bodesmith::fpaa {

/// Whole capacitors near given ones that make a linear prediction of the error small.
struct TrimProblem {
  std::vector<int> units;                                ///< as they are
  std::vector<std::complex<double>> error;               ///< got/wanted - 1 as it is, at each frequency
  std::vector<std::vector<std::complex<double>>> slope;  ///< d error / d ln C: [capacitor][frequency]
  double unit_variance = 0.0;  ///< k^2: what a unit that comes or goes adds, times 1/n^2
  int max_units = 255;
};

/// The best found: real least squares, rounded one capacitor after the other, then exchanges of one and two
/// capacitors by a unit or a few as long as the worst error drops (to which two standard deviations of what
/// the exchanges add belong). Deterministic.
std::vector<int> search_trim(const TrimProblem& problem);

}  // namespace bodesmith::fpaa
