#pragma once

#include "cli/command_line.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::cli {

/// --load-stroke, of commands that read a disturbance.
inline void add_load_option(CommandLine& line) {
  line.option<double>(
      "load-stroke",
      "share of the stroke that a stiff load leaves: the disturbance is taken over from its amplitude "
      "gains (disturbance paper, V.C.2)");
}
inline Disturbance under_load(const CommandLine& line, const Disturbance& disturbance) {
  const auto stroke = line.maybe_positive("load-stroke");
  return stroke ? disturbance.at_load(*stroke) : disturbance;
}

}  // namespace bodesmith::cli
