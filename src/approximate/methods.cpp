#include "approximate/method.hpp"

// Every method: one line here, and one file that defines the function.
#define BODESMITH_METHODS(ENTRY)  \
  ENTRY(minimax_method)           \
  ENTRY(oustaloup_method)         \
  ENTRY(refined_oustaloup_method) \
  ENTRY(matsuda_method)           \
  ENTRY(carlson_method)           \
  ENTRY(pade_method)              \
  ENTRY(charef_method)

namespace bodesmith {

#define BODESMITH_DECLARE(method) const Method& method();
BODESMITH_METHODS(BODESMITH_DECLARE)
#undef BODESMITH_DECLARE

Registry<Method>& method_registry() {
#define BODESMITH_ADDRESS(method) &method(),
  static Registry<Method> registry("approximation method", {BODESMITH_METHODS(BODESMITH_ADDRESS)});
#undef BODESMITH_ADDRESS
  return registry;
}

}  // namespace bodesmith

#undef BODESMITH_METHODS
