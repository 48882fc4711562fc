#include "project/output/run_files.hpp"

#include "base/documents/json.hpp"
#include "chain/model_file.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "project/output/run_model.hpp"
#include "schematic/writers/kicad/schematic.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/controller/files.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/generator/files.hpp"

namespace bodesmith::project {
namespace {

std::string json_file(std::string_view schema, const ProjectRun& run, const Json& body) {
  return to_text(timed_json(schema, run.from, body, run.design.compute_s));
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
  const synthesis::Realised& realised = run.design.realised();
  OutputSet spice;
  synthesis::add_compensator_files(realised, run.project.name, spice);
  out.include("spice", spice);
  out.add("spice/circuit.json", json_file("circuit", run, to_json(realised)));
}

void add_layout(const ProjectRun& run, OutputSet& out) {
  const generator::Layout& layout = run.design.layout;
  out.add("layout/layout.json", json_file("layout", run, to_json(layout)));
  out.add("layout/disturbance.sub", generator::disturbance_library(layout, run.project.name));
  if (layout.amplitude) {
    out.add("layout/disturbance_amplitude.sub",
            generator::disturbance_library(layout, run.project.name, {true, std::nullopt}));
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
    json.update(tolerance::to_json(*run.part_errors, controller));
    out.add("controller/trim.md",
            tolerance::trim_page(*run.part_errors, controller, "the controller of " + run.project.name));
  }
  controller::add_controller_files(controller, run.project.name, json, out);
}

}  // namespace

void add_board_files(const fpaa::Plan& plan, std::string plan_json, OutputSet& out) {
  out.add("fpaa/plan.json", std::move(plan_json));
  out.add("fpaa/board.svg", fpaa::board_picture_svg(plan));
  out.add("fpaa/build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("fpaa/build_sheet.html", fpaa::build_sheet_html(plan));
}

OutputSet design_files(const ProjectRun& run, const std::filesystem::path& folder) {
  OutputSet out(folder);
  out.add("cascade.json", json_file("cascade", run, run.design.fit.to_json()));
  out.add("sections.json", sections_file(run));
  if (const auto& plan = run.design.plan)
    add_board_files(*plan, json_file("fpaa_plan", run, plan->to_json()), out);
  if (run.design.circuit) add_circuit(run, out);
  add_layout(run, out);
  if (run.design.controller) add_controller(run, out);
  out.add("stage.toml", chain::model_text(stage_model(run.project, lowest_tracked(run.project)),
                                          "the stage of " + run.project.name));
  if (const auto built = built_model(run, lowest_tracked(run.project)))
    out.add("model.toml",
            chain::model_text(*built, "the controller as built and the stage of " + run.project.name));
  out.add("bode.csv", stages_csv(design_stages(run.design), stages_grid(run.budget.band)));
  out.add("bode.svg", report::stack_svg(stages_plots(run.project, run.design, run.budget)));
  return out;
}

}  // namespace bodesmith::project
