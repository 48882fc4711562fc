#include "approximate/oustaloup.hpp"

#include <cmath>

namespace bodesmith {

NormalisedApproximation oustaloup_recursion(double kappa, double beta, int order) {
  NormalisedApproximation out;
  for (int k = 1; k <= order; ++k) {
    // Exponents from the centre: aligned at -1/2 and +1/2 of the band.
    const double middle = (2 * k - 1) / (2.0 * order) - 0.5;
    const double half = beta / (2.0 * order);
    out.zeros.emplace_back(-std::pow(kappa, middle - half), 0.0);
    out.poles.emplace_back(-std::pow(kappa, middle + half), 0.0);
  }
  out.gain = std::pow(kappa, beta);  // at infinity; 1 at 0
  return out;
}

namespace {

class Oustaloup final : public Method {
 public:
  std::string_view name() const override { return "oustaloup"; }
  std::string_view source() const override { return "Oustaloup et al., IEEE Trans. CAS-I 47, 2000"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override {
    return oustaloup_recursion(task.kappa, task.beta, task.order);
  }
};

}  // namespace

const Method& oustaloup_method() {
  static const Oustaloup method;
  return method;
}

}  // namespace bodesmith
