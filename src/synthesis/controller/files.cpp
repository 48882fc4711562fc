#include "synthesis/controller/files.hpp"

#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "schematic/writers/kicad/schematic.hpp"
#include "schematic/writers/parts_table.hpp"

namespace bodesmith::generator {
namespace {

Json curve_json(const DisturbanceCircuit& controller) {
  return {{"corner_hz", hertz_values(controller.curve->corner)},
          {"ascending", controller.curve->gain[0]},
          {"descending", controller.curve->gain[1]},
          {"max_error", controller.curve->max_error},
          {"slope_v_per_hz", controller.slope->volts_per_hz},
          {"smoothing_s", controller.slope->smoothing_s}};
}

}  // namespace

Json controller_json(const DisturbanceCircuit& controller) {
  Json out = {{"form", std::string(to_string(controller.form))},
              {"opamp", controller.opamp.name},
              {"fast_opamp", controller.other_opamps.at(0).name}};
  out["multiplier"] = {{"name", controller.multiplier.name}, {"scale_v", controller.multiplier.scale_v}};
  out["switch"] = controller.analog_switch.name;
  out["branch_gain"] = controller.branch_gain;
  out["counts"] = {{"multipliers", controller.multipliers.size()},
                   {"opamps", controller.opamps.size()},
                   {"parts", controller.parts.size()},
                   {"contacts", controller.contacts.size()}};
  out["loop"] = {{"greatest_gain", controller.loop.greatest_gain},
                 {"least_slope", controller.loop.least_slope},
                 {"greatest_drive_v", controller.loop.greatest_drive}};
  if (controller.curve) out["rate_curve"] = curve_json(controller);
  if (controller.stroke) {
    out["least_stroke"] = controller.stroke->least;
    out["stroke_hold"] = {{"droop_percent", 100.0 * controller.stroke->droop},
                          {"charge_v", controller.stroke->charge_v},
                          {"error_percent", controller.stroke->hold_error_percent}};
  }
  out["max_error_percent"] = controller.max_error_percent;
  out["parts"] = schematic::parts_json(controller, "name");
  out["opamps"] = Json::array();
  for (const OpAmp& one : controller.opamps) {
    out["opamps"].push_back({{"name", one.name},
                             {"type", controller.model_of(one).name},
                             {"role", one.role},
                             {"section", controller.groups[one.group].title},
                             {"plus", one.plus},
                             {"minus", one.minus},
                             {"out", one.out}});
  }
  out["multipliers"] = Json::array();
  for (const Multiplier& one : controller.multipliers) {
    out["multipliers"].push_back({{"name", one.name},
                                  {"role", one.role},
                                  {"section", controller.groups[one.group].title},
                                  {"x", one.x},
                                  {"y", one.y},
                                  {"z", one.z},
                                  {"out", one.out},
                                  {"peak_v", one.peak_v}});
  }
  out["contacts"] = Json::array();
  for (const Contact& one : controller.contacts) {
    out["contacts"].push_back({{"name", one.name},
                               {"from", one.from},
                               {"to", one.to},
                               {"closed", one.position == 0 ? "rising" : "falling"}});
  }
  out["references"] = Json::array();
  for (const schematic::Source& one : controller.sources)
    out["references"].push_back(
        {{"name", one.name}, {"type", one.type}, {"node", one.node}, {"voltage_v", one.volts}});
  out["warnings"] = controller.warnings;
  return out;
}

void add_controller_files(const DisturbanceCircuit& controller, const std::string& title, const Json& json,
                          OutputSet& out, const std::filesystem::path& folder) {
  out.add(folder / "controller.sub", controller_library(controller, title));
  out.add(folder / "parts.csv", schematic::parts_csv(controller));
  out.add(folder / "controller.json", to_text(json));
  kicad::add_netlist_project(
      controller,
      {.stem = "controller",
       .title = title,
       .comment = fmt::format("bodesmith {}; op-amps {}, slope detector {}", kVersion, controller.opamp.name,
                              controller.other_opamps.at(0).name),
       .ports = {"r", "v"}},
      out, folder);
}

}  // namespace bodesmith::generator
