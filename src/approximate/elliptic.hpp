#pragma once

namespace bodesmith {

/// Jacobi's elliptic functions of a real argument.
struct EllipticFunctions {
  long double sn, cn, dn;
};

/// By descending Landen steps from the complementary modulus k' in (0, 1], which keeps moduli near 1 exact
/// (boost::math::jacobi_elliptic takes k, in which a k' below 1e-9 is lost).
EllipticFunctions jacobi_elliptic(long double argument, long double complementary_modulus);

}  // namespace bodesmith
