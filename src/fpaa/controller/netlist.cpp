#include "fpaa/controller/netlist.hpp"

#include <fmt/format.h>

namespace bodesmith::fpaa {
namespace {

/// V(node) of a part off the board.
std::string part_line(const OutsidePart& part, const VoltScale& scale,
                      const std::vector<std::string>& inputs) {
  const std::string node = output_node(part.name);
  switch (part.kind) {
    case OutsidePart::Kind::reference:
      return fmt::format("B{0} {0} 0 V={1:.15g}*(V(r)-{2:.15g})", node, scale.volts_per_stroke, scale.centre);
    case OutsidePart::Kind::constant:
      return fmt::format("V{0} {0} 0 {1:.15g}", node, part.value);
    case OutsidePart::Kind::multiplier:
      return fmt::format("B{0} {0} 0 V={1:.15g}*V({2})*V({3})", node, part.value, inputs[0], inputs[1]);
    case OutsidePart::Kind::switched:
      return fmt::format("B{0} {0} 0 V=V(rising)*V({1})+(1-V(rising))*V({2})", node, inputs[0], inputs[1]);
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
    stages.push_back({cam.name, &cam, 1.0 / cam.clock_a.value, nodes_of(cam.inputs)});
  std::vector<std::string> links;
  for (const OutsidePart& part : variant.outside)
    links.push_back(part_line(part, variant.scale, nodes_of(part.inputs)));
  links.push_back(fmt::format("Bv v 0 V=V({})/{:.15g}+{:.15g}", output_node(variant.drive),
                              variant.scale.volts_per_stroke, variant.scale.centre));
  return switched_library("controller r rising v", "the controller, and what stands off the board,", stages,
                          links, parts, title);
}

}  // namespace bodesmith::fpaa
