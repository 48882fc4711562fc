#include "filters/family.hpp"

// Every family: one line here, and one file in families/ that defines the function.
namespace bodesmith::filters {

BODESMITH_REGISTRY(Family, family_registry, "filter family", butterworth_family, chebyshev1_family,
                   chebyshev2_family, elliptic_family, bessel_family, linkwitz_riley_family, gaussian_family)

}  // namespace bodesmith::filters
