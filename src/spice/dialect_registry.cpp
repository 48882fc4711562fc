#include "spice/dialect.hpp"

namespace bodesmith::spice {

// One line a dialect: the function that its own file in dialects/ defines.
BODESMITH_REGISTRY(Dialect, dialect_registry, "SPICE dialect", ngspice_dialect, ltspice_dialect, xyce_dialect)

}  // namespace bodesmith::spice
