#include "spice/emit.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "spice/deck_text.hpp"

namespace bodesmith {
namespace {

/// A node of the chain as the stage's own subcircuit names it.
std::string local_node(const Stage& stage, int index, const std::string& node) {
  if (node == "0") return node;
  if (node == stage.in) return "in";
  if (node == stage.out) return "out";
  const std::string prefix = fmt::format("s{}_", index + 1);
  return node.starts_with(prefix) ? node.substr(prefix.size()) : node;
}

Json stage_json(const Circuit& circuit, int index) {
  const Stage& stage = circuit.stages[static_cast<size_t>(index)];
  const auto local = [&](const std::string& node) { return local_node(stage, index, node); };
  Json elements = Json::array();
  for (int i = 0; i < stage.part_count; ++i) {
    const Part& part = circuit.parts[static_cast<size_t>(stage.first_part + i)];
    elements.push_back({{"line", fmt::format("{} {} {} {}", part.name, local(part.from), local(part.to),
                                             spice_number(part.realised))}});
  }
  for (const OpAmp& opamp : circuit.opamps) {
    if (opamp.stage != index) continue;
    elements.push_back({{"line", fmt::format("X{} {} {} {} bodesmith_opamp", opamp.name, local(opamp.plus),
                                             local(opamp.minus), local(opamp.out))}});
  }
  return {{"number", index + 1},
          {"realization", stage.realization},
          {"wanted", transfer_text(stage.wanted)},
          {"realised", transfer_text(stage.realised)},
          {"in", stage.in},
          {"out", stage.out},
          {"elements", elements}};
}

/// Triangle of 0 to 1 V as PWL points; two periods.
std::string triangle_points(double frequency_hz) {
  std::string out = "0 0";
  for (int half = 1; half <= 4; ++half)
    out += fmt::format(" {:.12g} {}", half / (2.0 * frequency_hz), half % 2);
  return out;
}

}  // namespace

std::string compensator_library(const Circuit& circuit, const std::string& title) {
  Json stages = Json::array();
  for (int i = 0; i < static_cast<int>(circuit.stages.size()); ++i) stages.push_back(stage_json(circuit, i));
  return render_template(
      "spice/compensator.sub",
      {{"title", title}, {"version", kVersion}, {"stages", stages}, {"opamp", opamp_library(circuit.model)}});
}

std::string parts_csv(const Circuit& circuit) {
  std::string out = "part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f\n";
  for (const Part& part : circuit.parts) {
    const std::string wanted = number_text(part.wanted), realised = number_text(part.realised);
    out += part.kind == Part::Kind::resistor
               ? fmt::format("{},{},{},{},{},,\n", part.name, part.stage + 1, part.series, wanted, realised)
               : fmt::format("{},{},{},,,{},{}\n", part.name, part.stage + 1, part.series, wanted, realised);
  }
  return out;
}

void add_spice_files(const Realised& realised, const std::string& title, OutputSet& out) {
  const Circuit& circuit = realised.circuit;
  const Band& band = realised.report.band;
  const double middle = std::sqrt(band.from.value * band.to.value);
  out.add("compensator.sub", compensator_library(circuit, title));
  out.add("ac.cir", render_template("spice/ac.cir", {{"title", title},
                                                     {"from_hz", spice_number(band.from.value)},
                                                     {"to_hz", spice_number(band.to.value)}}));
  out.add("transient.cir",
          render_template("spice/transient.cir", {{"title", title},
                                                  {"frequency_hz", rounded_text(middle)},
                                                  {"points", triangle_points(middle)},
                                                  {"step_s", spice_number(1.0 / (middle * 1000.0))},
                                                  {"stop_s", spice_number(2.0 / middle)}}));
  out.add("parts.csv", parts_csv(circuit));
}

}  // namespace bodesmith
