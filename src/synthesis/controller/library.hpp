#pragma once

#include <string>

#include "schematic/netlist.hpp"
#include "synthesis/generator/at_rest.hpp"

/// What is told of the closed circuit: its netlist, its loop, its drive.
namespace bodesmith::generator {

struct LibraryOptions {
  /// Parts off their values; none: as realised. Not for the open loop.
  const Deviations* off = nullptr;
  /// The loop cut: `.subckt controller_open r x branch slope v`. The powers read x instead of v (self-fed) or r,
  /// `branch` above 0.5 V is the ascending one, `slope` takes the place of the slope meter (node sn, -V).
  bool open = false;
  double stroke = 1.0;  ///< of the open loop
};

/// `.subckt controller r v` and all it needs: for ngspice, LTspice and Xyce alike.
std::string controller_library(const DisturbanceCircuit& controller, const std::string& title,
                               const LibraryOptions& options = {});

}  // namespace bodesmith::generator
