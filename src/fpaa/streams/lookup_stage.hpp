#pragma once

#include <string>

#include "fpaa/cams/transfer_function.hpp"
#include "fpaa/device/memory_image.hpp"

namespace bodesmith::fpaa::an231 {

// The look-up stage (TransferFunction) where public vendor streams have it with nothing else in the way: in
// CAB 4, op-amp 1, C1 to C3, the converter on C7 and C8. Five vendor primaries of artecs-group/FPAA-NNs have it
// there, nine more in CAB 2 (C4 to C6), all with the same bytes but for the source's selector. Read off them:
//
//   C1 = 128 units from +2 V, C2 = the table's byte from -2 V, both given in phase 1 of the slow clock and
//   emptied in phase 2; C3 = Cout the feedback, op-amp reset in phase 2:  V = 2 V (LUT - 128)/Cout in phase 1.
//   C7 (170 units) takes up the input in phase 1 of the fast clock and gives it to the converter, whose reference
//   is C8 (128 units).
//
// The bytes of converter and table counter are copied; what they mean is not known.

inline constexpr int kLookupCab = 4;
inline constexpr int kLookupFastClock = 2;  ///< chip clock, ClockA of the CAB: 16 times the slow one
inline constexpr int kLookupSlowClock = 3;  ///< ClockB
inline constexpr int kLookupClockRatio = 16;
inline constexpr int kLookupOpAmps = 1;      ///< op-amp 1; op-amp 2 is free
inline constexpr int kLookupCapacitors = 3;  ///< C1 to C3
inline constexpr int kLookupFreeUpTo = 6;    ///< C4 to C6 are free

/// Table, output stage, converter and counter; the CAB's clocks and routes are its writer's.
void write_lookup(MemoryImage& memory, const LookupTable& table, int input_selector);

/// Which bytes were copied without being understood, and what has no precedent here.
std::string lookup_note(const std::string& name, int input_selector);

}  // namespace bodesmith::fpaa::an231
