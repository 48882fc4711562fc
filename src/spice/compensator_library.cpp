#include "spice/compensator_library.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text_template.hpp"
#include "base/version.hpp"
#include "circuit/stages/placement.hpp"
#include "circuit/text.hpp"
#include "spice/opamp_macromodel.hpp"

namespace bodesmith::spice {
namespace {

Json stage_fields(const circuit::Circuit& circuit, std::size_t index, const PartValue& value) {
  const circuit::Stage& stage = circuit.stages[index];
  const auto local = [&](const std::string& node) {
    return circuit::StageNodes::local_name(stage, index, node);
  };
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

}  // namespace

std::string compensator_library(const circuit::Circuit& circuit, const std::string& title) {
  return compensator_library(circuit, title,
                             [](const circuit::Part& part) { return circuit::plain_number(part.realised); });
}

std::string compensator_library(const circuit::Circuit& circuit, const std::string& title,
                                const PartValue& value) {
  Json stages = Json::array();
  for (std::size_t i = 0; i < circuit.stages.size(); ++i) stages.push_back(stage_fields(circuit, i, value));
  return render_template("spice/compensator.sub", {{"title", title},
                                                   {"version", kVersion},
                                                   {"stages", stages},
                                                   {"opamp", opamp_macromodel(circuit.model)}});
}

}  // namespace bodesmith::spice
