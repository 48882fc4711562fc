#include "faults/fault.hpp"

namespace bodesmith::faults {

// Each stands in a file of kinds/, which defines `const FaultKind& NAME_fault()`.
BODESMITH_REGISTRY(FaultKind, fault_kind_registry, "kind of fault", value_off_fault, wrong_decade_fault,
                   open_part_fault, shorted_part_fault, swapped_parts_fault, slow_opamp_fault,
                   missing_ground_fault, capacitive_load_fault, resistive_load_fault, wrong_capacitor_fault,
                   swapped_capacitors_fault, wrong_clock_fault)

}  // namespace bodesmith::faults
