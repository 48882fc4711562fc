#include <cmath>

#include "approximate/all_methods.hpp"
#include "approximate/log_symmetric.hpp"

namespace bodesmith {

// The continued fraction of the literature, cut off after 2n terms, is the same function; by the zeros of the
// Jacobi polynomial nothing cancels.
NormalisedApproximation pade(const ApproximationTask& task) {
  const long double log_kappa = std::log(static_cast<long double>(task.kappa));
  return from_log_positions(pade_positions(log_kappa, task.beta, task.order), log_kappa, task.beta);
}

}  // namespace bodesmith
