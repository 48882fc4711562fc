#pragma once

#include <boost/math/special_functions/ellint_rf.hpp>

namespace bodesmith {

/// Complete elliptic integral of the first kind from the complementary modulus k' in (0, 1], which keeps moduli near 1
/// exact (std::comp_ellint_1 takes k):
///   K(k) = R_F(0, k'^2, 1),  k^2 + k'^2 = 1   (Carlson; NIST DLMF 19.25.1).
inline long double complete_elliptic_k(long double complementary_modulus) {
  return boost::math::ellint_rf(0.0L, complementary_modulus * complementary_modulus, 1.0L);
}

}  // namespace bodesmith
