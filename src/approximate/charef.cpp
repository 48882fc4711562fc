#include <cmath>

#include "approximate/method.hpp"

namespace bodesmith {
namespace {

/// Singularity functions (Charef et al., IEEE Trans. AC 37, 1992). The rule for a fractional pole 1/(1 + s/p_T)^m with
/// error y dB:
///   a = 10^(y/(10(1-m))), b = 10^(y/(10 m)), p_0 = p_T sqrt(b), z_i = a p_i, p_(i+1) = b z_i.
/// A term with corners a..b holds n pairs when (a b)^n = kappa, which fixes y = 10 m (1-m) lg(kappa)/n. The
/// singularities then are those of Oustaloup's recursion; what Charef adds is the error that comes with them.
class Charef final : public Method {
 public:
  std::string_view name() const override { return "charef"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override {
    const double m = task.beta;
    const double y = 10.0 * m * (1.0 - m) * std::log10(task.kappa) / task.order;
    const double a = std::pow(10.0, y / (10.0 * (1.0 - m)));
    const double b = std::pow(10.0, y / (10.0 * m));
    NormalisedApproximation out;
    double first = std::sqrt(b / task.kappa);
    for (int i = 0; i < task.order; ++i) {
      // The lead is the reciprocal of the fractional pole: its "poles" are zeros here.
      out.zeros.emplace_back(-first, 0.0);
      out.poles.emplace_back(-first * a, 0.0);
      first *= a * b;
    }
    out.gain = std::pow(task.kappa, m);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Method, charef_method, Charef)

}  // namespace bodesmith
