#pragma once

#include <string>

#include "controller/controller.hpp"
#include "schematic/deviations.hpp"

namespace bodesmith::controller {

struct LibraryOptions {
  /// Parts off their values; none: as realised. Not for the open loop.
  const Deviations* off = nullptr;
  /// The loop cut: `.subckt controller_open r x branch slope v`. The powers read x instead of v (self-fed) or r,
  /// `branch` above 0.5 V is the ascending one, `slope` takes the place of the slope meter (node sn, -V).
  bool open = false;
};

/// `.subckt controller r v` and all it needs: for ngspice, LTspice and Xyce alike.
std::string controller_library(const AnalogController& controller, const std::string& title,
                               const LibraryOptions& options = {});

}  // namespace bodesmith::controller
