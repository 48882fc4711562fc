#pragma once

#include "controller/controller.hpp"

namespace bodesmith::controller {

/// Node in place of what the generator reads when its loop is cut.
inline constexpr const char* kArgument = "argument";

/// The whole controller with its loop cut: powers and weights read node kArgument instead of the last pass's argument, the switch
/// follows node branch (above 0.5 V: ascending), node slope (-V) takes the place of the slope meter.
schematic::Netlist opened(const AnalogController& controller);

/// The generator and the subtraction alone: powers, branches, switch, r - K d. What the slope meter and the gain curve make
/// comes from outside (it does not move with v). `cut`: powers and weights read node kArgument instead of the last pass's argument.
schematic::Netlist generator_netlist(const AnalogController& controller, bool cut);

}  // namespace bodesmith::controller
