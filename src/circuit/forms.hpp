#pragma once

#include "circuit/realization.hpp"

namespace bodesmith::circuit {

// One file a form; realizations() in realization.cpp lists them.
Realization first_order_realization();
Realization first_order_right_zero_realization();
Realization first_order_trimmed_realization();
Realization inverter_realization();
Realization khn_realization();
Realization multiple_feedback_realization();
Realization sallen_key_realization();
Realization tow_thomas_realization();

/// The section with its gain's sign turned round.
inline Section negated(Section section) {
  section.gain = -section.gain;
  return section;
}

}  // namespace bodesmith::circuit
