#include "synthesis/decks/compensator_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "lti/judge_responses.hpp"
#include "schematic/analysis/in_time.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/writers/kicad/schematic.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::synthesis {
namespace {

/// A stage by itself, between `in` and `out`.
schematic::Subcircuit stage_subcircuit(const Circuit& circuit, std::size_t index) {
  const Stage& stage = circuit.stages[index];
  schematic::Subcircuit out;
  out.name = fmt::format("compensator_stage{}", index + 1);
  out.pins = {"in", "out"};
  out.comments = {fmt::format("stage {}: {}", index + 1, stage.realisation),
                  "wanted   " + transfer_text(stage.wanted), "realised " + transfer_text(stage.realised)};
  out.netlist = schematic::subset(circuit, [&](std::size_t group) { return group == index; });
  out.netlist.groups = {{"", schematic::Purpose::stage}};
  const auto local = [&](std::string& node) { node = StageNodes::local_name(stage, index, node); };
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
std::string sheet_text(const Stage& stage) {
  if (stage.wanted.size() == 1) return stage.realisation + "\n" + transfer_text(stage.wanted);
  return fmt::format("{}\n{} poles, {} to {} rad/s", stage.realisation, stage.wanted.size(),
                     rounded_text(std::abs(stage.wanted.front().section().poles[0])),
                     rounded_text(std::abs(stage.wanted.back().section().poles[0])));
}

}  // namespace

schematic::SpiceLibrary compensator_library(const Circuit& circuit, const std::string& title) {
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

void add_compensator_files(const Realised& realised, const std::string& title, OutputSet& out) {
  const Circuit& circuit = realised.circuit;
  const DeckRequest request{circuit, title, realised.report.band};
  out.add("compensator.sub", schematic::spice_text(compensator_library(circuit, title)));
  for (const Dialect* dialect : dialect_registry().all()) {
    for (const Deck& deck : dialect->decks(request)) out.add(deck.file, deck.text);
  }
  out.add("parts.csv", parts_csv(circuit));
  std::vector<kicad::ChainStage> chain;
  for (const Stage& stage : circuit.stages)
    chain.push_back({stage.in, stage.out, fmt::format("stage {}: {}", chain.size() + 1, sheet_text(stage))});
  kicad::add_chain_project(circuit, chain,
                           {.stem = "compensator",
                            .title = title,
                            .comment = fmt::format("bodesmith {}; op-amps {}", kVersion, circuit.opamp.name),
                            .ports = {"in", "out"}},
                           out);
}

namespace {

double check_transient(const Circuit& circuit, const std::string& library, double frequency_hz) {
  const double period = 1.0 / frequency_hz;
  const std::string points = triangle_points(frequency_hz);
  const ngspice::Transient got =
      ngspice::run_transient("triangle\n" + library + "Vin in 0 PWL(" + points + ")\nXc in out compensator\n",
                             {"out"}, period / 1000.0, 2.0 * period, "compensator.sub");
  const auto triangle = [&](double t) {
    const double phase = t / period - std::floor(t / period);
    return phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
  };
  schematic::InTime run(circuit, triangle);
  run.begin(0.0);
  double worst = 0.0, peak = 0.0;
  std::size_t i = 0;
  for (int half = 1; half <= 4; ++half) {
    run.run_to(0.5 * half * period, [&](double from, double to) {
      for (; i < got.time_s.size() && got.time_s[i] <= to; ++i) {
        const double here = run.volts("out", std::max(got.time_s[i], from));
        worst = std::max(worst, std::abs(got.v[0][i] - here));
        peak = std::max(peak, std::abs(here));
      }
    });
  }
  return peak > 0.0 ? 100.0 * worst / peak : 0.0;
}

double check_noise(const Circuit& circuit, const std::string& library, Band band) {
  const ngspice::NoiseSpectrum got = ngspice::run_noise_of_text(library, band, 5, "compensator.sub");
  const std::vector<double> own = schematic::output_noise(circuit, got.grid);
  double worst = 0.0;
  for (size_t i = 0; i < own.size(); ++i)
    worst = std::max(worst, 100.0 * std::abs(got.v_per_rthz[i] / own[i] - 1.0));
  return worst;
}

}  // namespace

CompensatorCheck check_compensator(const Circuit& circuit, const Sections& wanted) {
  CompensatorCheck out;
  out.band = searched_band(without_far_zeros(wanted));
  const std::string library = schematic::spice_text(compensator_library(circuit, "check"));
  const Responses network = [&](const std::vector<Hertz>& grid) {
    return schematic::network_response(circuit, grid, {.ideal_opamps = circuit.opamp.is_ideal});
  };
  const Responses sections = at_each([&](RadPerSecond w) { return wanted.response(w); });
  // As the program judges its own: beside a notch a plain grid has other errors, and no flanks. Where the network is furthest from
  // the sections ngspice is as well, but for what it is off the network: one run of it has all frequencies.
  const std::vector<Hertz> grid = judged_frequencies(network, sections, out.band);
  const std::vector<Complex> in_ngspice = ngspice::run_ac_of_text(library, "compensator.sub", grid);
  out.against_network = compare_responses(grid, in_ngspice, network(grid));
  out.against_sections = compare_responses(grid, in_ngspice, sections(grid));
  out.transient_percent =
      check_transient(circuit, library, std::sqrt(out.band.from.value * out.band.to.value));
  out.noise_percent = check_noise(circuit, library, out.band);
  return out;
}

Json to_json(const CompensatorCheck& check) {
  return {{"version", ngspice::version()},
          {"band_hz", {check.band.from.value, check.band.to.value}},
          {"against_program", to_json(check.against_network)},
          {"against_sections", to_json(check.against_sections)},
          {"transient_percent", check.transient_percent},
          {"noise_percent", check.noise_percent}};
}

}  // namespace bodesmith::synthesis
