#pragma once

#include <array>

#include "signal/disturbance.hpp"
#include "tracking/reference.hpp"

namespace bodesmith::tracking {

/// The disturbance at one amplitude and operating frequency, as the generator or the stage makes it:
///   k_b(f) alpha_b(alpha) d_b(x/alpha).
class BranchCurve {
 public:
  /// Without `operating`: rate gains of 1.
  BranchCurve(const Disturbance& disturbance, double alpha);
  BranchCurve(const Disturbance& disturbance, double alpha, Hertz operating);

  double value(std::size_t branch, double x) const {
    const std::array<double, 3>& a = a_[branch];
    return x * (a[0] + x * (a[1] + x * a[2]));
  }
  double slope(std::size_t branch, double x) const {
    const std::array<double, 3>& a = a_[branch];
    return a[0] + x * (2.0 * a[1] + x * 3.0 * a[2]);
  }
  /// Largest |d'| of a branch over 0 ... alpha: the gain of a loop round the generator.
  double steepest(std::size_t branch) const;

 private:
  std::array<std::array<double, 3>, 2> a_{};  ///< of x itself
  double alpha_;
};

}  // namespace bodesmith::tracking
