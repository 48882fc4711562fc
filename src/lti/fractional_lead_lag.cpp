#include "lti/fractional_lead_lag.hpp"

#include <cmath>

namespace bodesmith {

double FractionalLeadLag::log_magnitude(RadPerSecond w) const {
  // (1 + a^2) / (1 + b^2) = 1 + (a^2 - b^2)/(1 + b^2), a = lw, b = xlw: exact near w = 0, where both tend
  // to 1. With a < b the reciprocal is taken, so that the argument of log1p is never close to -1.
  const double a = lambda_s * w.value;
  const double b = x * a;
  if (a > 1e150 || b > 1e150) return -beta * std::log(x);
  return a >= b ? 0.5 * beta * std::log1p((a - b) * (a + b) / (1.0 + b * b))
                : -0.5 * beta * std::log1p((b - a) * (b + a) / (1.0 + a * a));
}

double FractionalLeadLag::phase_rad(RadPerSecond w) const {
  const double a = lambda_s * w.value;
  const double b = x * a;
  if (a > 1e150 || b > 1e150) return 0.0;
  // atan a - atan b in one arctangent: no cancellation.
  return beta * std::atan2(a - b, 1.0 + a * b);
}

std::complex<double> FractionalLeadLag::response(RadPerSecond w) const {
  return std::polar(std::exp(log_magnitude(w)), phase_rad(w));
}

}  // namespace bodesmith
