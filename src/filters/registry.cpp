#include "filters/family.hpp"

// Every family: one line here, and one file in families/ that defines the function.
#define BODESMITH_FAMILIES(ENTRY) \
  ENTRY(butterworth_family)       \
  ENTRY(chebyshev1_family)        \
  ENTRY(chebyshev2_family)        \
  ENTRY(elliptic_family)          \
  ENTRY(bessel_family)            \
  ENTRY(linkwitz_riley_family)    \
  ENTRY(gaussian_family)

namespace bodesmith::filters {

#define BODESMITH_DECLARE(family) const Family& family();
BODESMITH_FAMILIES(BODESMITH_DECLARE)
#undef BODESMITH_DECLARE

Registry<Family>& family_registry() {
#define BODESMITH_ADDRESS(family) &family(),
  static Registry<Family> registry("filter family", {BODESMITH_FAMILIES(BODESMITH_ADDRESS)});
#undef BODESMITH_ADDRESS
  return registry;
}

}  // namespace bodesmith::filters

#undef BODESMITH_FAMILIES
