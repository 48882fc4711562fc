#pragma once

#include <string>

#include "fpaa/plan.hpp"

namespace bodesmith::fpaa {

/// The board as an SVG: chips, CABs, CAMs in them, wires along the signal path, clocks, resources used.
std::string board_picture_svg(const Plan& plan);

}  // namespace bodesmith::fpaa
