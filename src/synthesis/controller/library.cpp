#include "synthesis/controller/library.hpp"

#include <fmt/format.h>

#include "base/version.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::controller {
namespace {

bool is_generator(Purpose purpose) {
  return purpose == Purpose::powers || purpose == Purpose::branch;
}

/// What the generator reads, by another name: the last pass's argument becomes `argument`, those before it what they divide.
/// `divided`: what the last one divides becomes `argument`.
void rename_arguments(const AnalogController& controller, const std::string& argument, bool divided,
                      schematic::Netlist& out) {
  const auto read = [&](std::size_t group, std::string& node) {
    const Purpose purpose = controller.purpose_of(group);
    if (divided && controller.stroke) {
      if (purpose == Purpose::division && node == controller.passes.back().from) node = argument;
      return;
    }
    if (!is_generator(purpose)) return;
    for (const Pass& one : controller.passes) {
      if (node == one.x) {
        node = &one == &controller.passes.back() ? argument : one.from;
        return;
      }
    }
  };
  for (Part& one : out.parts) {
    read(one.group, one.from);
    read(one.group, one.to);
  }
  for (Multiplier& one : out.multipliers) {
    for (std::string* node : {&one.x, &one.y, &one.z}) read(one.group, *node);
  }
}

}  // namespace

schematic::Netlist opened(const AnalogController& controller, double stroke) {
  schematic::Netlist out = schematic::subset(controller, [&](std::size_t group) {
    const Purpose purpose = controller.purpose_of(group);
    return purpose != Purpose::slope_sign && purpose != Purpose::slope_meter && purpose != Purpose::stroke;
  });
  rename_arguments(controller, kArgument, true, out);
  if (controller.stroke) {
    out.sources.push_back({"Vstroke", "", "al", stroke});
    out.sources.push_back({"Vminus", "", "an", -stroke});
  }
  for (Part& one : out.parts) {
    for (std::string* node : {&one.from, &one.to}) {
      if (*node == "sn") *node = "slope";
    }
  }
  for (schematic::Comparator& one : out.comparators) {
    one.in = "branch";
    one.gain = 40.0;
    one.threshold_v = 0.5;
  }
  return out;
}

schematic::Netlist generator_netlist(const AnalogController& controller, bool cut, bool divided) {
  schematic::Netlist out = schematic::subset(controller, [&](std::size_t group) {
    const Purpose purpose = controller.purpose_of(group);
    return is_generator(purpose) || purpose == Purpose::branch_switch || purpose == Purpose::output ||
           (divided && purpose == Purpose::division);
  });
  out.sources = {{"Vr", "", "r", 0.0}};
  rename_arguments(controller, cut ? kArgument : controller.passes.back().from, divided, out);
  return out;
}

std::string controller_library(const AnalogController& controller, const std::string& title,
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

}  // namespace bodesmith::controller
