#include "project/run_files.hpp"

#include <algorithm>
#include <optional>
#include <tuple>

#include "base/json.hpp"
#include "base/json_header.hpp"
#include "chain/chain.hpp"
#include "chain/model_file.hpp"
#include "chain/registry.hpp"
#include "chain/sections_chain.hpp"
#include "chain/stage_chain.hpp"
#include "circuit/json.hpp"
#include "controller/at_rest.hpp"
#include "controller/files.hpp"
#include "kicad/netlist_sheet.hpp"
#include "kicad/schematic.hpp"
#include "multiplier_layout/json.hpp"
#include "project/artefacts.hpp"
#include "spice/compensator_library.hpp"
#include "spice/disturbance_library.hpp"

namespace bodesmith::project {
namespace {

using Branch = Disturbance::Branch;
using chain::Block;
using chain::make_block;

Hertz lowest_tracked(const Project& project) {
  return *std::min_element(project.track.frequency.begin(), project.track.frequency.end());
}

Block called(Block block, const char* name) {
  block.part = name;
  return block;
}

Block loop_of(const controller::AnalogController& controller, const Disturbance& disturbance,
              Hertz operating) {
  controller::BuiltGenerator built(controller);
  std::vector<double> frequency;
  for (const Hertz f : disturbance.rate.frequency) frequency.push_back(f.value);
  Block out = make_block("loop");
  for (const auto& [which, list, constant, rates] :
       {std::tuple{Branch::ascending, "ascending", "constant_ascending", "rate_ascending"},
        {Branch::descending, "descending", "constant_descending", "rate_descending"}}) {
    // A cubic through four of its values: what the powers, sums and gains with their parts make.
    built.set_rate(operating);
    const double gain = built.rate_gain(which);
    double y[4];
    for (int i = 0; i < 4; ++i) y[i] = built.subtracted(which, i / 3.0) / gain;
    const double d1 = y[1] - y[0];
    const double d2 = y[2] - 2.0 * y[1] + y[0];
    const double d3 = y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0];
    out.set(list, std::vector<double>{3.0 * d1 - 1.5 * d2 + d3, 4.5 * d2 - 4.5 * d3, 4.5 * d3});
    out.set(constant, y[0] * gain);
    std::vector<double> gains;
    for (const Hertz f : disturbance.rate.frequency) {
      built.set_rate(f);
      gains.push_back(built.rate_gain(which));
    }
    out.set(rates, gains);
  }
  out.set("rate_frequency_hz", frequency).set("operating_hz", operating.value);
  out.set("passes", controller.form == controller::Form::self_fed   ? 0.0
                    : controller.form == controller::Form::two_pass ? 2.0
                                                                    : 1.0);
  return called(std::move(out), "controller");
}

/// The stage as the project has it, per unit of the full-stroke drive: amplifier, hysteresis, damping compensator,
/// resonance, stroke (m).
chain::Chain stage_model(const Project& project) {
  chain::Chain out;
  const Project::Plant& plant = project.plant;
  if (plant.amplifier_corner)
    out.blocks.push_back(
        called(make_block("lowpass").set("corner_hz", plant.amplifier_corner->value), "amplifier"));
  out.blocks.push_back(chain::stage_block(project.target.disturbance, lowest_tracked(project)));
  if (plant.damping_compensator) {
    Sections one;
    one.sections = {*plant.damping_compensator};
    for (Block& block : chain::chain_of(one, "damping").blocks) out.blocks.push_back(std::move(block));
  }
  if (plant.resonance)
    out.blocks.push_back(called(make_block("resonator")
                                    .set("natural_frequency_hz", plant.resonance->value)
                                    .set("damping_ratio", plant.damping_ratio),
                                "resonance"));
  out.blocks.push_back(called(make_block("gain").set("gain", plant.stroke_m), "stroke_m"));
  return out;
}

/// The whole chain as built, from the reference to the displacement: the analog controller as its parts make its polynomials
/// and rate gains (a `loop`), then the stage. Nothing where no controller was built. Rate gains are those of the lowest
/// tracked frequency (`operating_hz`).
std::optional<chain::Chain> built_model(const ProjectRun& run) {
  if (!run.design.controller) return std::nullopt;
  chain::Chain out = stage_model(run.project);
  out.blocks.insert(out.blocks.begin(), loop_of(*run.design.controller, run.project.target.disturbance,
                                                lowest_tracked(run.project)));
  return out;
}

std::string json_file(std::string_view schema, const ProjectRun& run, const Json& body) {
  return artefact_json(schema, run.from, body, run.design.compute_s);
}

std::string sections_file(const ProjectRun& run) {
  const Design& design = run.design;
  Sections built = design.sections();
  if (!built.error) {
    const ApproximationError error = approximation_error(built, design.fit.cascade);
    built.error = Sections::Error{error.band, error.band_db, error.band_deg, error.everywhere_db};
  }
  Json sections = built.to_json();
  sections["made_by"] = design.built().name;
  if (design.built().kind == Alternative::Kind::cascade) sections.update(design.approximation.report_json());
  return json_file("sections", run, sections);
}

void add_circuit(const ProjectRun& run, OutputSet& out) {
  const circuit::Realised& realised = run.design.realised();
  OutputSet spice;
  spice::add_spice_files(realised, run.project.name, spice);
  kicad::add_kicad_files(realised.circuit, run.project.name, spice);
  out.include("spice", spice);
  out.add("spice/circuit.json", json_file("circuit", run, to_json(realised)));
}

void add_layout(const ProjectRun& run, OutputSet& out) {
  const multiplier_layout::Layout& layout = run.design.layout;
  out.add("layout/layout.json", json_file("layout", run, to_json(layout)));
  out.add("layout/disturbance.sub", spice::disturbance_library(layout, run.project.name));
  if (layout.amplitude) {
    out.add("layout/disturbance_amplitude.sub",
            spice::disturbance_library(layout, run.project.name, {true, std::nullopt}));
  }
  out.add("layout/disturbance.svg", kicad::netlist_svg(layout.whole(), {.stem = "layout",
                                                                        .title = "Disturbance generator",
                                                                        .comment = "",
                                                                        .ports = layout.ports(),
                                                                        .tolerances = {}}));
}

void add_controller(const ProjectRun& run, OutputSet& out) {
  const controller::AnalogController& controller = *run.design.controller;
  Json json = json_header("analog_controller", run.from);
  json.update(controller::to_json(controller));
  if (run.part_errors) {
    json.update(part_errors::to_json(*run.part_errors, controller));
    out.add("controller/trim.md",
            part_errors::trim_page(*run.part_errors, controller, "the controller of " + run.project.name));
  }
  controller::add_controller_files(controller, run.project.name, json, out);
}

}  // namespace

OutputSet design_files(const ProjectRun& run, const std::filesystem::path& folder) {
  OutputSet out(folder);
  out.add("cascade.json", json_file("cascade", run, run.design.fit.to_json()));
  out.add("sections.json", sections_file(run));
  if (const auto& plan = run.design.plan)
    add_board_files(*plan, json_file("fpaa_plan", run, plan->to_json()), out);
  if (run.design.circuit) add_circuit(run, out);
  add_layout(run, out);
  if (run.design.controller) add_controller(run, out);
  out.add("stage.toml", chain::model_text(stage_model(run.project), "the stage of " + run.project.name));
  if (const auto built = built_model(run))
    out.add("model.toml",
            chain::model_text(*built, "the controller as built and the stage of " + run.project.name));
  out.add("bode.csv", stages_csv(design_stages(run.design), stages_grid(run.budget.band)));
  out.add("bode.svg", report::stack_svg(stages_plots(run.project, run.design, run.budget)));
  return out;
}

}  // namespace bodesmith::project
