#pragma once

#include <map>
#include <string>

#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// What to write at a pin instead of its name: "chip1.in1" -> "r".
using PinLabels = std::map<std::string, std::string>;

/// The board as an SVG: chips, CABs, CAMs in them, every wire, clocks, resources used.
std::string board_picture_svg(const Plan& plan, const PinLabels& labels = {});

}  // namespace bodesmith::fpaa
