#pragma once

#include <complex>
#include <vector>

#include "approximate/method.hpp"

namespace bodesmith {

/// Approximations that share the symmetry of P(s) = ((1 + r s)/(1 + s/r)): P(s) P(1/s) = kappa. Their zeros and poles
/// are mirror images in log frequency,
///   H(s) = kappa^(beta/2) prod_k exp(zeta_k/2) (s + exp(-zeta_k/2)) / (s + exp(zeta_k/2)),
/// so that with v = 2 ln w
///   ln |H(jw)| - (beta/2) ln kappa = sum_k half_lead(v, zeta_k),
/// the target being beta half_lead(v, ln kappa): odd functions of v, all made of
///   half_lead(v, z) = artanh(tanh(v/2) tanh(z/2)).
/// On the real axis, s = exp(y): ln H(e^y) - (beta/2) ln kappa = sum_k 2 half_lead(y, zeta_k/2).
long double half_lead(long double v, long double z);
/// d half_lead / dz = sinh v / (2 (cosh v + cosh z)).
long double half_lead_slope(long double v, long double z);

/// Poles and zeros from the positions zeta_k; complex ones closed under conjugation.
NormalisedApproximation from_log_positions(const std::vector<std::complex<long double>>& zeta,
                                           long double log_kappa, long double beta);

/// Where the minimax positions lie for many poles and beta < 3/2: equally spaced in the elliptic argument,
///   tanh(zeta_k/2) = m sn(K (1 - (4k - 1 - 2 beta)/(2n + 1)), m'),  k = 1..n,
/// with m = (kappa - 1)/(kappa + 1). (For kappa -> 1 these are the asymptotic zeros of the Jacobi polynomials of the
/// mid-band Pade approximation.)
std::vector<long double> elliptic_positions(long double log_kappa, long double beta, int order);

/// Positions of the diagonal Pade approximant about the centre s = 1, 0 < beta < 2: with q = (s - 1)/(s + 1) and
/// m = (r - 1)/(r + 1), r = sqrt(kappa),
///   P = r (1 + m q)/(1 - m q),
/// and the approximant of ((1 + z)/(1 - z))^beta at z = 0 is prod (1 + x_k z)/(1 - x_k z), x_k the zeros of the Jacobi
/// polynomial P_n^(-beta,beta), which are the eigenvalues of a tridiagonal matrix.
std::vector<long double> pade_positions(long double log_kappa, long double beta, int order);

/// The same for any beta: above 2 some come in conjugate pairs.
std::vector<std::complex<long double>> pade_positions_complex(long double log_kappa, long double beta,
                                                              int order);

/// Jacobi's elliptic functions of a real argument.
struct EllipticFunctions {
  long double sn, cn, dn;
};

/// By descending Landen steps from the complementary modulus k' in (0, 1], which keeps moduli near 1 exact
/// (boost::math::jacobi_elliptic takes k, in which a k' below 1e-9 is lost).
EllipticFunctions jacobi_elliptic(long double argument, long double complementary_modulus);

}  // namespace bodesmith
