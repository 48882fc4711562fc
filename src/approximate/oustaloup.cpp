#include <cmath>

#include "approximate/all_methods.hpp"

namespace bodesmith {

NormalisedApproximation oustaloup(const ApproximationTask& task) {
  NormalisedApproximation out;
  for (int k = 1; k <= task.order; ++k) {
    // Exponents from the centre: aligned at -1/2 and +1/2 of the band.
    const double middle = (2 * k - 1) / (2.0 * task.order) - 0.5;
    const double half = task.beta / (2.0 * task.order);
    out.zeros.emplace_back(-std::pow(task.kappa, middle - half), 0.0);
    out.poles.emplace_back(-std::pow(task.kappa, middle + half), 0.0);
  }
  out.gain = std::pow(task.kappa, task.beta);  // at infinity; 1 at 0
  return out;
}

}  // namespace bodesmith
