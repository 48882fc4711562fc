#include "faults/fault.hpp"

namespace bodesmith::faults {

// Each stands in a file of its own in kinds/, which defines `const FaultKind& NAME_fault()`.
#define BODESMITH_FAULTS(ENTRY) \
  ENTRY(value_off)              \
  ENTRY(wrong_decade)           \
  ENTRY(open_part)              \
  ENTRY(shorted_part)           \
  ENTRY(swapped_parts)          \
  ENTRY(slow_opamp)             \
  ENTRY(missing_ground)         \
  ENTRY(capacitive_load)        \
  ENTRY(resistive_load)         \
  ENTRY(wrong_capacitor)        \
  ENTRY(swapped_capacitors)     \
  ENTRY(wrong_clock)

#define BODESMITH_DECLARE_FAULT(entry) const FaultKind& entry##_fault();
BODESMITH_FAULTS(BODESMITH_DECLARE_FAULT)
#undef BODESMITH_DECLARE_FAULT

#define BODESMITH_LIST_FAULT(entry) &entry##_fault(),
Registry<FaultKind>& fault_kind_registry() {
  static Registry<FaultKind> registry("kind of fault", {BODESMITH_FAULTS(BODESMITH_LIST_FAULT)});
  return registry;
}
#undef BODESMITH_LIST_FAULT
#undef BODESMITH_FAULTS

}  // namespace bodesmith::faults
