#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "approximate/method.hpp"

namespace bodesmith {
namespace {

/// Newton's iteration for P^(1/q) (Carlson and Halijak, IEEE Trans. CT 11, 1964). The step for a square root,
///   H <- H (H^2 + 3 p)/(3 H^2 + p)  from H = 1,
/// triples an exponent:
///   (H - c)/(H + c) = ((1 - c)/(1 + c))^N,  c = sqrt p,  N = 3^steps = 2 n + 1,
/// so that its zeros and poles are p = -tan^2 of equally spaced angles: no polynomial needs to be expanded. (At these
/// orders it equals the continued fraction; for q-th roots other than the square root it would not, and these are
/// refused.)
class Carlson final : public Method {
 public:
  std::string_view name() const override { return "carlson"; }
  Outcome<NormalisedApproximation> approximate(const ApproximationTask& task) const override;
};

Outcome<NormalisedApproximation> Carlson::approximate(const ApproximationTask& task) const {
  if (std::abs(task.beta - 0.5) > 1e-12) {
    return Refusal{fmt::format(
        "carlson is built for |beta| = 1/2 plus whole powers, expected another method for this beta ({:f} remains)",
        task.beta)};
  }
  int n = 1;
  while (n < task.order) n = 3 * n + 1;
  if (n != task.order) {
    return Refusal{fmt::format(
        "carlson has 1, 4, 13 or 40 poles plus whole powers, expected such an order instead of {}",
        task.order)};
  }
  const int count = 2 * n + 1;
  const double r = std::sqrt(task.kappa);
  NormalisedApproximation out;
  out.gain = std::pow(task.kappa, 0.25);
  const auto corner = [&](double angle) {
    // p = P/r = (s + 1/r)/(1 + s/r) = -tan^2: s = -(1/r + T)/(1 + T/r).
    const double t = std::tan(angle) * std::tan(angle);
    return (1.0 / r + t) / (1.0 + t / r);
  };
  for (int k = 1; k <= n; ++k) {
    const double pole = corner(std::numbers::pi * k / count);
    const double zero = corner(std::numbers::pi * (k - 0.5) / count);
    // H = 1 where p = 1, i.e. at s = 1.
    out.zeros.emplace_back(-zero, 0.0);
    out.poles.emplace_back(-pole, 0.0);
    out.gain *= (1.0 + pole) / (1.0 + zero);
  }
  return out;
}

}  // namespace

BODESMITH_ENTRY(Method, carlson_method, Carlson)

}  // namespace bodesmith
