#pragma once

#include <string>

#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// Whether the Zrna client can place it: one chip, one path, modules that the client has.
bool has_zrna_script(const Plan& plan);
/// A Python script for the open Zrna client that places one chip's CAMs, connects them between AudioIn and
/// AudioOut, sets the divisors, and prints what the board realised beside what the plan realises. Throws
/// DesignError for a plan of more than one chip (a Zrna board has one).
std::string zrna_script(const Plan& plan);

}  // namespace bodesmith::fpaa
