#pragma once

#include <optional>
#include <string>

#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// What a person types into AnadigmDesigner2, in its words and in the order one types it: chip clocks, CAMs
/// with option, clock, phase and parameters, wires, then what the CAM dialogs should show (realised values,
/// capacitors).
std::string build_sheet_markdown(const Plan& plan);
/// The same as one page of HTML that needs nothing else.
std::string build_sheet_html(const Plan& plan);

/// A Python script for the open Zrna client that places one chip's CAMs, connects them between AudioIn and
/// AudioOut, sets the divisors, and prints what the board realised next to what the plan realises. Nothing where the client cannot place
/// it: more than one chip (a Zrna board has one) or path, modules that it does not have.
std::optional<std::string> zrna_script(const Plan& plan);

}  // namespace bodesmith::fpaa
