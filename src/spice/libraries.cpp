#include "spice/libraries.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/version.hpp"
#include "circuit/circuit.hpp"
#include "circuit/stages/placement.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::spice {
namespace {

std::string codes_of(const multiplier_layout::Layout& layout) {
  std::vector<std::string> out;
  for (int select = 0; select < (1 << layout.select_lines()); ++select) {
    for (const bool rising : {true, false}) {
      const int b = layout.branch_at(select, rising);
      if (b >= 0)
        out.push_back(fmt::format("{}{}: {}", select, rising ? " up" : " down",
                                  layout.branches[static_cast<size_t>(b)].name));
    }
  }
  return join(out, ", ");
}

std::vector<std::string> notes_of(const multiplier_layout::Layout& layout, bool amplitude) {
  std::vector<std::string> out = {fmt::format(
      "x: 1 V is full stroke; branch above 0.5 V: {}; out: 1 V is d = 1. {}", layout.branches[0].name,
      amplitude ? "With the amplitude gains." : "Without the gain tables.")};
  if (layout.select_lines() > 0) out.push_back("select lines, binary, select1 lowest; " + codes_of(layout));
  if (amplitude) {
    out.push_back(
        "amplitude: the stroke alpha, 1 V is full stroke; x is the reference divided by alpha, 0 to 1 V.");
    out.push_back("This file stands alone: it is not to be included beside disturbance.sub.");
  }
  out.push_back("slope_detector x branch: makes the branch signal from the slope of x.");
  out.push_back("No analysis and no control section: for ngspice, LTspice and Xyce alike.");
  return out;
}

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

}  // namespace

std::string disturbance_pins(const multiplier_layout::Layout& layout, bool amplitude) {
  std::string out = "x branch";
  for (int line = 1; line <= layout.select_lines(); ++line) out += fmt::format(" select{}", line);
  return out + (amplitude ? " amplitude out" : " out");
}

std::string disturbance_library(const multiplier_layout::Layout& layout, const std::string& title,
                                const DisturbanceLibrary& options) {
  schematic::SpiceLibrary out;
  out.title = title;
  out.written_by = std::string("bodesmith ") + kVersion;
  out.top = options.amplitude ? "disturbance_amplitude" : "disturbance";
  out.notes = notes_of(layout, options.amplitude);
  schematic::Subcircuit top;
  top.name = out.top;
  const std::string pins = disturbance_pins(layout, options.amplitude);
  for (const std::string_view pin : split(pins, ' ')) top.pins.emplace_back(pin);
  top.netlist = layout.generator(options.amplitude);
  schematic::Deviations off = schematic::Deviations::none(top.netlist);
  if (options.errors)
    off.multiplier.assign(top.netlist.multipliers.size(), options.errors->multiplier_at_limit());
  out.subcircuits.push_back(std::move(top));
  if (layout.switched())
    out.subcircuits.push_back(
        {"slope_detector",
         {"x", "branch"},
         {"slope detector: differentiator with a logarithmic limit, comparator with hysteresis, 0 V or 1 V out"},
         layout.detector_netlist()});
  return schematic::spice_text(out, {.off = options.errors ? &off : nullptr});
}

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

void add_spice_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                     const MonteCarloOptions& monte_carlo) {
  const DeckRequest request{realised.circuit, title, realised.report.band, monte_carlo};
  out.add("compensator.sub", schematic::spice_text(compensator_library(realised.circuit, title)));
  for (const Dialect* dialect : dialect_registry().all()) {
    for (const Deck& deck : dialect->decks(request)) out.add(deck.file, deck.text);
  }
  out.add("parts.csv", circuit::parts_csv(realised.circuit));
}

}  // namespace bodesmith::spice
