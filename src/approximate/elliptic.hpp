#pragma once

namespace bodesmith {

/// Jacobi's elliptic functions of a real argument.
struct EllipticFunctions {
  long double sn, cn, dn;
};

/// By descending Landen steps from the complementary modulus k' in (0, 1], which keeps moduli near 1 exact.
EllipticFunctions jacobi_elliptic(long double argument, long double complementary_modulus);

/// Complete elliptic integral of the first kind from the complementary modulus k' in (0, 1], by the arithmetic-geometric
/// mean:
///   K(k) = pi / (2 agm(1, k')),  k^2 + k'^2 = 1.
/// In the precision of its argument: double or long double.
template <class Real>
Real complete_elliptic_k(Real complementary_modulus);

extern template double complete_elliptic_k(double);
extern template long double complete_elliptic_k(long double);

}  // namespace bodesmith
