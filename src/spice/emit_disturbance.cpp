#include <fmt/format.h>

#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "spice/deck_text.hpp"
#include "spice/emit.hpp"

namespace bodesmith {
namespace {

Json line_of(const LayoutPart& part) {
  return {{"line", fmt::format("{} {} {} {}", part.name, part.from, part.to, spice_number(part.realised))}};
}

Json branch_json(const DisturbanceLayout& layout, size_t index) {
  const LayoutBranch& branch = layout.branches[index];
  Json resistors = Json::array();
  bool plus_used = false;
  for (size_t k = 0; k < branch.weight.size(); ++k) {
    if (branch.weight[k] < 0) continue;
    resistors.push_back(line_of(layout.part(branch.weight[k])));
    plus_used = plus_used || branch.at_plus[k];
  }
  resistors.push_back(line_of(layout.part(branch.feedback)));
  if (branch.balance >= 0) resistors.push_back(line_of(layout.part(branch.balance)));
  return {{"name", branch.name},
          {"node", branch.out},
          {"gain", rounded_text(layout.branch_gain, 6)},
          {"number", index + 1},
          {"plus", plus_used ? branch.plus : "0"},
          {"minus", branch.minus},
          {"resistors", resistors}};
}

}  // namespace

std::string disturbance_library(const DisturbanceLayout& layout, const std::string& title) {
  Json data;
  data["title"] = title;
  data["version"] = kVersion;
  data["first_branch"] = layout.branches[0].name;
  data["multipliers"] = Json::array();
  for (const LayoutMultiplier& m : layout.multipliers) {
    data["multipliers"].push_back({{"name", m.name}, {"x", m.x}, {"y", m.y}, {"w", m.out}});
  }
  data["branches"] = Json::array();
  for (size_t i = 0; i < layout.branches.size(); ++i) data["branches"].push_back(branch_json(layout, i));
  data["output"] =
      Json::array({line_of(layout.part(layout.output_input)), line_of(layout.part(layout.output_feedback))});
  data["output_number"] = layout.branches.size() + 1;
  data["detector"] = Json::array();
  for (const int index : layout.detector) data["detector"].push_back(line_of(layout.part(index)));
  data["switched"] = layout.branches.size() > 1;
  data["on_ohm"] = spice_number(layout.switch_on_ohm);
  data["off_siemens"] = "1e-10";
  data["half_siemens"] = spice_number(0.5 / std::max(layout.switch_on_ohm, 1e-3));
  data["multiplier"] = layout.multiplier.name;
  data["scale_v"] = spice_number(layout.multiplier.scale_v);
  data["inverse_scale"] = spice_number(1.0 / layout.multiplier.scale_v);
  data["bandwidth_hz"] = spice_number(layout.multiplier.bandwidth.value);
  data["pole_f"] = spice_number(1.0 / layout.multiplier.bandwidth.rad_s().value);
  data["limit_v"] = spice_number(layout.multiplier.greatest_output_v);
  data["opamp"] = opamp_library(layout.opamp);
  return render_template("spice/disturbance.sub", data);
}

}  // namespace bodesmith
