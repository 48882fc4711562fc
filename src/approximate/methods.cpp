#include "approximate/method.hpp"

// Every method: one line here, and one file that defines the function.
namespace bodesmith {

BODESMITH_REGISTRY(Method, method_registry, "approximation method", minimax_method, oustaloup_method,
                   refined_oustaloup_method, matsuda_method, carlson_method, pade_method, charef_method)

}  // namespace bodesmith
