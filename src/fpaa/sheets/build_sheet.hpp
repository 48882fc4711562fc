#pragma once

#include <string>

#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// What a person types into AnadigmDesigner2, in its words and in the order one types it: chip clocks, CAMs
/// with option, clock, phase and parameters, wires, then what the CAM dialogs should show (realised values,
/// capacitors).
std::string build_sheet_markdown(const Plan& plan);
/// The same as one page of HTML that needs nothing else.
std::string build_sheet_html(const Plan& plan);

}  // namespace bodesmith::fpaa
