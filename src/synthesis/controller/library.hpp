#pragma once

#include <string>

#include "schematic/netlist.hpp"
#include "synthesis/controller/controller.hpp"

namespace bodesmith::controller {

struct LibraryOptions {
  /// Parts off their values; none: as realised. Not for the open loop.
  const Deviations* off = nullptr;
  /// The loop cut: `.subckt controller_open r x branch slope v`. The powers read x instead of v (self-fed) or r,
  /// `branch` above 0.5 V is the ascending one, `slope` takes the place of the slope meter (node sn, -V).
  bool open = false;
  double stroke = 1.0;  ///< of the open loop
};

/// `.subckt controller r v` and all it needs: for ngspice, LTspice and Xyce alike.
std::string controller_library(const AnalogController& controller, const std::string& title,
                               const LibraryOptions& options = {});

/// Node in place of what the generator reads when its loop is cut.
inline constexpr const char* kArgument = "argument";

/// The whole controller with its loop cut: powers and weights read node kArgument instead of the last pass's argument, the switch
/// follows node branch (above 0.5 V: ascending), node slope (-V) takes the place of the slope meter. With amplitude gains the argument is
/// divided by `stroke`.
schematic::Netlist opened(const AnalogController& controller, double stroke = 1.0);

/// The generator and the subtraction alone: powers, branches, switch, r - K d. What the slope meter and the gain curve make
/// comes from outside (it does not move with v). `cut`: powers and weights read node kArgument instead of the last pass's argument.
/// With amplitude gains that is what is divided by the stroke already, or, `divided`, the input of the division by node al.
schematic::Netlist generator_netlist(const AnalogController& controller, bool cut, bool divided = false);

}  // namespace bodesmith::controller
