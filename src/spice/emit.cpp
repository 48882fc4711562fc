#include "spice/emit.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "circuit/text.hpp"
#include "spice/opamp_macromodel.hpp"

namespace bodesmith::spice {
namespace {

using circuit::plain_number;

/// A node of the chain as the stage's own subcircuit names it.
std::string local_node(const circuit::Stage& stage, std::size_t index, const std::string& node) {
  if (node == "0") return node;
  if (node == stage.in) return "in";
  if (node == stage.out) return "out";
  const std::string prefix = fmt::format("s{}_", index + 1);
  return node.starts_with(prefix) ? node.substr(prefix.size()) : node;
}

std::string fixed_value(const circuit::Part& part) {
  return plain_number(part.realised);
}

std::string spread_value(const circuit::Part& part) {
  return fmt::format(
      "{{mc({},{})}}", plain_number(part.realised),
      part.kind == circuit::Part::Kind::resistor ? "resistor_tolerance" : "capacitor_tolerance");
}

using ValueText = std::string (*)(const circuit::Part&);

Json stage_json(const circuit::Circuit& circuit, std::size_t index, ValueText value) {
  const circuit::Stage& stage = circuit.stages[index];
  const auto local = [&](const std::string& node) { return local_node(stage, index, node); };
  Json elements = Json::array();
  for (const circuit::Part& part : circuit.parts_of(stage)) {
    elements.push_back(
        {{"line", fmt::format("{} {} {} {}", part.name, local(part.from), local(part.to), value(part))}});
  }
  for (const circuit::OpAmp& opamp : circuit.opamps) {
    if (opamp.stage != index) continue;
    elements.push_back({{"line", fmt::format("X{} {} {} {} bodesmith_opamp", opamp.name, local(opamp.plus),
                                             local(opamp.minus), local(opamp.out))}});
  }
  return {{"number", index + 1},
          {"realization", stage.realisation},
          {"wanted", circuit::transfer_text(stage.wanted)},
          {"realised", circuit::transfer_text(stage.realised)},
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

std::string library(const circuit::Circuit& circuit, const std::string& title, ValueText value) {
  Json stages = Json::array();
  for (std::size_t i = 0; i < circuit.stages.size(); ++i)
    stages.push_back(stage_json(circuit, i, value));
  return render_template("spice/compensator.sub", {{"title", title},
                                                   {"version", kVersion},
                                                   {"stages", stages},
                                                   {"opamp", opamp_macromodel(circuit.model)}});
}

/// ngspice names a part of a subcircuit r.xc.x1.r1_1.
Json alters(const circuit::Circuit& circuit, const circuit::Tolerances& tolerances) {
  Json out = Json::array();
  for (const circuit::Part& part : circuit.parts) {
    const bool resistor = part.kind == circuit::Part::Kind::resistor;
    std::string name = part.name;
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const double tolerance = (resistor ? tolerances.resistor_percent : tolerances.capacitor_percent) / 100.0;
    out.push_back(
        {{"line", fmt::format("alter {}.xc.x{}.{} = {}*(1+{}*sunif(0))", resistor ? "r" : "c", part.stage + 1,
                              name, plain_number(part.realised), plain_number(tolerance))}});
  }
  return out;
}

}  // namespace

std::string compensator_library(const circuit::Circuit& circuit, const std::string& title) {
  return library(circuit, title, fixed_value);
}

std::string compensator_library_with_tolerances(const circuit::Circuit& circuit, const std::string& title) {
  return library(circuit, title, spread_value);
}

void add_spice_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                     const MonteCarloOptions& monte_carlo) {
  const circuit::Tolerances& tolerances = monte_carlo.tolerances;
  const circuit::Circuit& circuit = realised.circuit;
  const Band& band = realised.report.band;
  const double middle = std::sqrt(band.from.value * band.to.value);
  Json data;
  data["title"] = title;
  data["from_hz"] = plain_number(band.from.value);
  data["to_hz"] = plain_number(band.to.value);
  data["frequency_hz"] = rounded_text(middle);
  data["points"] = triangle_points(middle);
  data["step_s"] = plain_number(1.0 / (middle * 1000.0));
  data["stop_s"] = plain_number(2.0 / middle);
  data["runs"] = monte_carlo.runs;
  data["seed"] = monte_carlo.seed;
  data["resistor_percent"] = plain_number(tolerances.resistor_percent);
  data["capacitor_percent"] = plain_number(tolerances.capacitor_percent);
  data["resistor_tolerance"] = plain_number(tolerances.resistor_percent / 100.0);
  data["capacitor_tolerance"] = plain_number(tolerances.capacitor_percent / 100.0);
  data["alters"] = alters(circuit, tolerances);
  out.add("compensator.sub", compensator_library(circuit, title));
  out.add("compensator_mc.sub",
          compensator_library_with_tolerances(circuit, title + ", LTspice with tolerances"));
  for (const char* deck : {"ac.cir", "transient.cir", "noise.cir", "monte_carlo_ngspice.cir",
                           "ltspice_ac.cir", "ltspice_monte_carlo.cir", "xyce_ac.cir"}) {
    out.add(deck, render_template(std::string("spice/") + deck, data));
  }
  out.add("parts.csv", circuit::parts_csv(circuit));
}

}  // namespace bodesmith::spice
