#pragma once

namespace bodesmith {

/// The smallest possible error, in dB, of any stable real rational approximation with n poles of
/// ((s/a + 1)/(s/b + 1))^beta over all frequencies, kappa = b/a > 1, K = complete elliptic integral
/// (modulus):
///   E = (40/ln 10) |sin pi beta| |Gamma(n+1+beta) Gamma(n+1-beta)| / (Gamma(n+1/2) Gamma(n+3/2))
///       * exp(-pi (2n+1) K(1/kappa) / K(sqrt(1 - kappa^-2))).
/// Asymptotic in n: within 0.4 % of the true minimax where E < 0.1 dB, up to 9 % too low above 1 dB.
/// 0 for a whole beta with |beta| <= n. Meaningful for |beta| < n + 1; throws std::domain_error otherwise or
/// when kappa <= 1 or n < 0.
double minimax_limit_db(double kappa, double beta, int n);

/// Smallest n <= max_order whose law is at or below max_db; max_order + 1 when there is none.
int minimax_order(double kappa, double beta, double max_db, int max_order);

}  // namespace bodesmith
