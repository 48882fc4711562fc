#pragma once

#include <string>

#include "fpaa/controller/controller.hpp"
#include "fpaa/sheets/board_netlist.hpp"

namespace bodesmith::fpaa {

/// The variant as switched capacitors (board_netlist), and what stands off the board: `.subckt controller r rising v`. 1 V at r is
/// full stroke wanted, 1 V at `rising` while the reference rises (its generator drives the switch), 1 V at v full-stroke drive. AD835s
/// and switch are ideal. Throws DesignError: a CAM whose switches are not known, as all variants have but those with multipliers outside.
std::string controller_netlist(const ControllerVariant& variant, const NetlistParts& parts,
                               const std::string& title);

}  // namespace bodesmith::fpaa
