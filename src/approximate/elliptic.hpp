#pragma once

namespace bodesmith {

/// Jacobi's elliptic functions of a real argument.
struct EllipticFunctions {
  long double sn, cn, dn;
};

/// By descending Landen steps from the complementary modulus k' in (0, 1], which keeps moduli near 1 exact.
EllipticFunctions jacobi_elliptic(long double argument, long double complementary_modulus);
/// K(k) = pi / (2 agm(1, k')).
long double complete_elliptic_k_long(long double complementary_modulus);

}  // namespace bodesmith
