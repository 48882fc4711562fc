#include "spice/dialect.hpp"

namespace bodesmith::spice {

// One line a dialect: the function that its own file in dialects/ defines.
#define BODESMITH_DIALECTS(ENTRY) \
  ENTRY(ngspice_dialect)          \
  ENTRY(ltspice_dialect)          \
  ENTRY(xyce_dialect)

#define BODESMITH_DECLARE(NAME) const Dialect& NAME();
BODESMITH_DIALECTS(BODESMITH_DECLARE)
#undef BODESMITH_DECLARE

Registry<Dialect>& dialect_registry() {
#define BODESMITH_ENTRY(NAME) &NAME(),
  static Registry<Dialect> registry("SPICE dialect", {BODESMITH_DIALECTS(BODESMITH_ENTRY)});
#undef BODESMITH_ENTRY
  return registry;
}
#undef BODESMITH_DIALECTS

}  // namespace bodesmith::spice
