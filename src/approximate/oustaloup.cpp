#include <cmath>
#include <complex>

#include "approximate/method.hpp"
#include "numeric/quadratic_roots.hpp"

namespace bodesmith {
namespace {

/// Recursive poles and zeros, evenly spaced in log frequency, k = 1..n:
///   w_k = kappa^((2k - 1)/(2n) - 1/2),  zero_k = -w_k kappa^(-beta/(2n)),  pole_k = -w_k kappa^(beta/(2n)).
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

/// Oustaloup et al., IEEE Trans. CAS-I 47, 2000.
class Oustaloup final : public Method {
 public:
  std::string_view name() const override { return "oustaloup"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override {
    return oustaloup_recursion(task.kappa, task.beta, task.order);
  }
};

/// Oustaloup over a wider band with a Taylor correction (Xue, Zhao and Chen, ICMA 2006). The refinement widens the
/// band by b/d = 10/9 on both sides and multiplies by the first-order Taylor expansion of (target/widened)^beta. Its
/// target is s^beta, here it is the term itself: P = N0/D0, widened W = N1/D1,
///   (P/W)^beta ~ 1 + beta (P/W - 1) = (beta N + (1 - beta) D)/D,  N = N0 D1,  D = D0 N1.
class RefinedOustaloup final : public Method {
 public:
  std::string_view name() const override { return "refined-oustaloup"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override;
};

Outcome<NormalisedApproximation> RefinedOustaloup::approximate(const ApproximationTask& task) const {
  if (task.order < 3)
    return Refusal{
        "refined-oustaloup needs an order of at least 3 plus whole powers (its correction takes 2)"};
  const double widen = 10.0 / 9.0;
  const double r = std::sqrt(task.kappa);
  const double wide = r * widen;
  NormalisedApproximation out = oustaloup_recursion(wide * wide, task.beta, task.order - 2);
  // N = (1 + r s)(1 + s/wide), D = (1 + s/r)(1 + wide s).
  const double n1 = r + 1.0 / wide;
  const double n2 = r / wide;
  const double d1 = 1.0 / r + wide;
  const double d2 = wide / r;
  const double c1 = task.beta * n1 + (1.0 - task.beta) * d1;
  const double c2 = task.beta * n2 + (1.0 - task.beta) * d2;
  // Both are real: c1^2 > 4 c2 because c1 > 2 and c2 lies between 9/10 and 10/9... for every kappa > 1.
  for (const std::complex<double> root : quadratic_roots(1.0, c1, c2)) out.zeros.push_back(root);
  out.poles.emplace_back(-r, 0.0);
  out.poles.emplace_back(-1.0 / wide, 0.0);
  out.gain *= c2 / d2;
  return out;
}

}  // namespace

BODESMITH_ENTRY(Method, oustaloup_method, Oustaloup)

BODESMITH_ENTRY(Method, refined_oustaloup_method, RefinedOustaloup)

}  // namespace bodesmith
