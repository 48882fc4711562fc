#include "project/output/run_files.hpp"

#include "base/documents/json.hpp"
#include "chain/model_file.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "fpaa/sheets/build_sheet.hpp"
#include "project/output/circuit_model.hpp"
#include "project/output/run_model.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/controller/files.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/generator/files.hpp"

namespace bodesmith::project {
namespace {

std::string json_file(std::string_view schema, const Run& run, const Json& body) {
  return to_text(timed_json(schema, run.from, body, run.design.compute_s));
}

std::string sections_file(const Run& run) {
  const Design& design = run.design;
  Sections built = design.sections();
  const bool approximated = design.approximation && design.built().kind == Alternative::Kind::cascade;
  if (run.project.plant && !built.error) {
    const ApproximationError error = approximation_error(built, design.fit->cascade);
    built.error = Sections::Error{error.band, error.band_db, error.band_deg, error.everywhere_db};
  }
  Json sections = built.to_json();
  if (design.direct) sections["fit"] = design.direct->report_json();
  if (run.project.plant) {
    sections["made_by"] = design.built().name;
    if (approximated) sections.update(design.approximation->report_json());
  } else if (approximated) {
    sections["approximation"] = design.approximation->report_json();
  }
  return json_file("sections", run, sections);
}

void add_board(const Run& run, OutputSet& out) {
  const fpaa::Plan& plan = *run.design.plan;
  out.add("fpaa/plan.json", json_file("fpaa_plan", run, plan.to_json()));
  out.add("fpaa/board.svg", fpaa::board_picture_svg(plan));
  out.add("fpaa/build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("fpaa/build_sheet.html", fpaa::build_sheet_html(plan));
}

void add_circuit(const Run& run, OutputSet& out) {
  const synthesis::Candidate& best = run.design.circuit->best;
  OutputSet spice;
  synthesis::add_compensator_files(best.made, run.project.name, spice);
  out.include("spice", spice);
  Json json = synthesis::to_json(best.made);
  json["judged"] = synthesis::judged_json(best.judged, best.judged_band);
  json["shortfalls"] = best.shortfalls;
  out.add("spice/circuit.json", json_file("circuit", run, json));
}

std::string yield_file(const Run& run) {
  tolerance::Options options;
  options.spread = run.project.spread;
  options.limit_db = run.project.limits.yield_db;
  return json_file("yield", run,
                   {{"designs", Json::array({tolerance::to_json(*run.design.yield, options)})}});
}

void add_layout(const Run& run, OutputSet& out) {
  const generator::DisturbanceCircuit& layout = *run.design.layout;
  out.add("layout/layout.json", json_file("layout", run, to_json(layout)));
  generator::add_libraries(layout, run.project.name, out, "layout");
  out.add("layout/disturbance.svg", generator::layout_svg(layout));
}

void add_controller(const Run& run, OutputSet& out) {
  const generator::DisturbanceCircuit& controller = *run.design.controller;
  Json json = json_header("analog_controller", run.from);
  json.update(generator::controller_json(controller));
  if (run.part_errors) {
    json.update(tolerance::to_json(*run.part_errors, controller));
    out.add("controller/trim.md",
            tolerance::trim_page(*run.part_errors, controller, "the controller of " + run.project.name));
  }
  generator::add_controller_files(controller, run.project.name, json, out);
}

}  // namespace

OutputSet design_files(const Run& run, const std::filesystem::path& folder) {
  const Project& project = run.project;
  const Design& design = run.design;
  OutputSet out(folder);
  if (design.fit) out.add("cascade.json", json_file("cascade", run, design.fit->to_json()));
  out.add("sections.json", sections_file(run));
  if (design.plan) add_board(run, out);
  if (design.circuit) add_circuit(run, out);
  if (design.yield) out.add("yield.json", yield_file(run));
  if (design.layout) add_layout(run, out);
  if (design.controller) add_controller(run, out);
  if (project.plant)
    out.add("stage.toml",
            chain::model_text(stage_model(project, lowest_tracked(project)), "the stage of " + project.name));
  if (const auto built = built_model(run)) {
    out.add("model.toml",
            chain::model_text(*built, "the controller as built and the stage of " + project.name));
  } else if (design.circuit && !project.plant) {
    out.add("model.toml", chain::model_text({.blocks = circuit_blocks(design.realised().circuit)},
                                            "the circuit as built of " + project.name));
  }
  out.add("bode.csv", stages_csv(design_stages(project, design), stages_grid(project, design)));
  out.add("bode.svg", report::stack_svg(stages_plots(project, design)));
  return out;
}

}  // namespace bodesmith::project
