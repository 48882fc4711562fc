#include <cmath>

#include "approximate/log_symmetric.hpp"
#include "approximate/method.hpp"

namespace bodesmith {
namespace {

/// Continued fraction at the centre of the band: the diagonal Pade approximant. The continued fraction of the
/// literature, cut off after 2n terms, is the same function; by the zeros of the Jacobi polynomial nothing cancels.
class Pade final : public Method {
 public:
  std::string_view name() const override { return "pade"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override {
    const long double log_kappa = std::log(static_cast<long double>(task.kappa));
    const std::vector<long double> zeta = pade_positions(log_kappa, task.beta, task.order);
    return from_log_positions({zeta.begin(), zeta.end()}, log_kappa, task.beta);
  }
};

}  // namespace

BODESMITH_ENTRY(Method, pade_method, Pade)

}  // namespace bodesmith
