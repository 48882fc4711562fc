#include "fpaa/controller/netlist.hpp"

#include <fmt/format.h>

#include <utility>

namespace bodesmith::fpaa {
namespace {

/// V(node) of a part off the board.
std::string volts_of(const OutsidePart& part, const VoltScale& scale,
                     const std::vector<std::string>& inputs) {
  switch (part.kind) {
    case OutsidePart::Kind::reference:
      return fmt::format("{:.15g}*(V(r)-{:.15g})", scale.volts_per_stroke, scale.centre);
    case OutsidePart::Kind::constant:
      return fmt::format("{:.15g}", part.value);
    case OutsidePart::Kind::multiplier:
      return fmt::format("{:.15g}*V({})*V({})", part.value, inputs[0], inputs[1]);
    case OutsidePart::Kind::switched:
      return fmt::format("V(rising)*V({})+(1-V(rising))*V({})", inputs[0], inputs[1]);
  }
  return {};
}

std::vector<std::string> nodes_of(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names) out.push_back(output_node(name));
  return out;
}

}  // namespace

std::string controller_netlist(const ControllerVariant& variant, const NetlistParts& parts,
                               const std::string& title) {
  std::vector<NetlistStage> stages;
  for (const ControllerCam& cam : variant.cams)
    stages.push_back({cam.name, &cam, 1.0 / cam.clock_a.value, nodes_of(cam.inputs), output_node(cam.name)});
  schematic::Subcircuit top{"controller", {"r", "rising", "v"}, {}, {}};
  const auto add = [&](const std::string& node, std::string volts) {
    top.netlist.expressions.push_back({"B" + node, node, std::move(volts)});
  };
  for (const OutsidePart& part : variant.outside)
    add(output_node(part.name), volts_of(part, variant.scale, nodes_of(part.inputs)));
  add("v", fmt::format("V({})/{:.15g}+{:.15g}", output_node(variant.drive), variant.scale.volts_per_stroke,
                       variant.scale.centre));
  return switched_library(std::move(top), "The controller, and what stands off the board,", stages, parts,
                          title);
}

}  // namespace bodesmith::fpaa
