#include "approximate/limit_law.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "numeric/elliptic_k.hpp"

namespace bodesmith {
namespace {

/// ln Gamma(x), x > 0. The standard's own leaves its sign in a variable that all threads share.
double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace

double minimax_limit_db(double kappa, double beta, int n) {
  const double size = std::abs(beta);
  if (!(kappa > 1.0) || n < 0 || !(size < n + 1))
    throw std::domain_error("the limit law needs kappa > 1 and |beta| < n + 1");
  if (beta == std::round(beta)) return 0.0;
  const double k = 1.0 / kappa;
  // K(1/kappa) / K(sqrt(1 - kappa^-2))
  const auto ratio =
      static_cast<double>(complete_elliptic_k(std::sqrt((1.0 - k) * (1.0 + k))) / complete_elliptic_k(k));
  const double exponent =
      log_gamma(n + 1 + size) + log_gamma(n + 1 - size) - log_gamma(n + 0.5) - log_gamma(n + 1.5);
  return 2.0 * kDecibelPerNeper * std::abs(std::sin(std::numbers::pi * beta)) *
         std::exp(exponent - std::numbers::pi * (2 * n + 1) * ratio);
}

int minimax_order(double kappa, double beta, double max_db, int max_order) {
  for (int n = whole_number<int>(std::floor(std::abs(beta))); n <= max_order; ++n) {
    if (minimax_limit_db(kappa, beta, n) <= max_db) return n;
  }
  return max_order + 1;
}

}  // namespace bodesmith
