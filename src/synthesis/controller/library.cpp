#include "synthesis/controller/library.hpp"

#include <fmt/format.h>

#include "base/version.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::generator {

std::string controller_library(const DisturbanceCircuit& controller, const std::string& title,
                               const LibraryOptions& options) {
  schematic::SpiceLibrary out;
  out.title = title;
  out.written_by = std::string("bodesmith ") + kVersion;
  out.top = options.open ? "controller_open" : "controller";
  out.notes = {
      fmt::format(
          "The whole analog controller, {}: r, 1 V is full stroke wanted; v, 1 V is full-stroke drive. "
          "Input r from 0 V on.",
          to_string(controller.form)),
      "No analysis and no control section: for ngspice, LTspice and Xyce alike."};
  schematic::Subcircuit top;
  top.name = out.top;
  top.pins = options.open ? std::vector<std::string>{"r", kArgument, "branch", "slope", "v"}
                          : std::vector<std::string>{"r", "v"};
  top.netlist =
      options.open ? opened(controller, options.stroke) : static_cast<const schematic::Netlist&>(controller);
  out.subcircuits.push_back(std::move(top));
  return schematic::spice_text(out, {.off = options.off, .noise = false});
}

}  // namespace bodesmith::generator
