#include "synthesis/decks/compensator_files.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "base/text.hpp"
#include "base/version.hpp"
#include "schematic/writers/kicad/schematic.hpp"
#include "synthesis/stages/placement.hpp"

namespace bodesmith::spice {
namespace {

/// A stage by itself, between `in` and `out`.
schematic::Subcircuit stage_subcircuit(const circuit::Circuit& circuit, std::size_t index) {
  const circuit::Stage& stage = circuit.stages[index];
  schematic::Subcircuit out;
  out.name = fmt::format("compensator_stage{}", index + 1);
  out.pins = {"in", "out"};
  out.comments = {fmt::format("stage {}: {}", index + 1, stage.realisation),
                  "wanted   " + circuit::transfer_text(stage.wanted),
                  "realised " + circuit::transfer_text(stage.realised)};
  out.netlist = schematic::subset(circuit, [&](std::size_t group) { return group == index; });
  out.netlist.groups = {{"", schematic::Purpose::stage}};
  const auto local = [&](std::string& node) { node = circuit::StageNodes::local_name(stage, index, node); };
  for (schematic::Part& one : out.netlist.parts) {
    local(one.from);
    local(one.to);
    one.group = 0;
  }
  for (schematic::OpAmp& one : out.netlist.opamps) {
    for (std::string* node : {&one.plus, &one.minus, &one.out}) local(*node);
    one.group = 0;
  }
  return out;
}

/// What is written above it on the sheet.
std::string sheet_text(const circuit::Stage& stage) {
  if (stage.wanted.size() == 1) return stage.realisation + "\n" + circuit::transfer_text(stage.wanted);
  return fmt::format("{}\n{} poles, {} to {} rad/s", stage.realisation, stage.wanted.size(),
                     rounded_text(std::abs(stage.wanted.front().section().poles[0])),
                     rounded_text(std::abs(stage.wanted.back().section().poles[0])));
}

}  // namespace

schematic::SpiceLibrary compensator_library(const circuit::Circuit& circuit, const std::string& title) {
  schematic::SpiceLibrary out;
  out.title = title;
  out.written_by = std::string("bodesmith ") + kVersion;
  out.top = "compensator";
  out.notes = {"No analysis and no control section: for ngspice, LTspice and Xyce alike."};
  schematic::Subcircuit top;
  top.name = out.top;
  top.pins = {"in", "out"};
  top.netlist.groups = {{"", schematic::Purpose::stage}};
  for (std::size_t i = 0; i < circuit.stages.size(); ++i) {
    out.subcircuits.push_back(stage_subcircuit(circuit, i));
    top.netlist.instances.push_back({std::to_string(i + 1),
                                     0,
                                     {circuit.stages[i].in, circuit.stages[i].out},
                                     out.subcircuits.back().name});
  }
  out.subcircuits.push_back(std::move(top));
  return out;
}

void add_compensator_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                           const MonteCarloOptions& monte_carlo) {
  const circuit::Circuit& circuit = realised.circuit;
  const DeckRequest request{circuit, title, realised.report.band, monte_carlo};
  out.add("compensator.sub", schematic::spice_text(compensator_library(circuit, title)));
  for (const Dialect* dialect : dialect_registry().all()) {
    for (const Deck& deck : dialect->decks(request)) out.add(deck.file, deck.text);
  }
  out.add("parts.csv", circuit::parts_csv(circuit));
  std::vector<kicad::ChainStage> chain;
  for (const circuit::Stage& stage : circuit.stages)
    chain.push_back({stage.in, stage.out, fmt::format("stage {}: {}", chain.size() + 1, sheet_text(stage))});
  kicad::add_chain_project(circuit, chain,
                           {.stem = "compensator",
                            .title = title,
                            .comment = fmt::format("bodesmith {}; op-amps {}", kVersion, circuit.opamp.name),
                            .ports = {"in", "out"},
                            .tolerances = {}},
                           out);
}

}  // namespace bodesmith::spice
