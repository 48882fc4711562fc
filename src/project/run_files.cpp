#include "project/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "base/json_header.hpp"
#include "circuit/json.hpp"
#include "controller/files.hpp"
#include "fpaa/board_picture.hpp"
#include "fpaa/build_sheet.hpp"
#include "kicad/schematic.hpp"
#include "multiplier_layout/json.hpp"
#include "project/stages_plot.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"
#include "spice/disturbance_library.hpp"
#include "spice/emit.hpp"

namespace bodesmith::project {
namespace {

std::string json_file(std::string_view schema, const ProjectRun& run, const Json& body) {
  Json json = json_header(schema, run.from);
  json.update(body);
  json["timing_s"] = {{"compute", run.design.compute_s}};
  return to_text(json);
}

/// Every stage's response, a decade beyond the compared band on either side.
std::string stages_csv(const ProjectRun& run) {
  const std::vector<Hertz> grid = stages_grid(run.budget.band);
  CsvWriter csv;
  std::vector<double> hertz;
  for (const Hertz f : grid) hertz.push_back(f.value);
  csv.add(column::frequency_hz, hertz);
  for (const DesignStage& stage : design_stages(run.design)) {
    std::vector<double> db;
    std::vector<double> degrees;
    for (const Hertz f : grid) {
      const std::complex<double> h = stage.response(f.rad_s());
      db.push_back(to_decibel(std::abs(h)));
      degrees.push_back(to_degrees(std::arg(h)));
    }
    std::string name = stage.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    std::replace(name.begin(), name.end(), '-', '_');
    csv.add(fmt::format("{}_{}", name, column::magnitude_db), db);
    csv.add(fmt::format("{}_{}", name, column::phase_deg), degrees);
  }
  return csv.text();
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

void add_plan(const ProjectRun& run, OutputSet& out) {
  const fpaa::Plan& plan = *run.design.plan;
  out.add("fpaa/plan.json", json_file("fpaa_plan", run, plan.to_json()));
  out.add("fpaa/board.svg", fpaa::board_picture_svg(plan));
  out.add("fpaa/build_sheet.md", fpaa::build_sheet_markdown(plan));
  out.add("fpaa/build_sheet.html", fpaa::build_sheet_html(plan));
}

void add_circuit(const ProjectRun& run, OutputSet& out) {
  const circuit::Realised& realised = *run.design.circuit;
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
  out.add("layout/disturbance.svg", multiplier_layout::drawing_svg(layout));
}

void add_controller(const ProjectRun& run, OutputSet& out) {
  const controller::AnalogController& controller = *run.design.controller;
  Json json = json_header("controller", run.from);
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
  if (run.design.plan) add_plan(run, out);
  if (run.design.circuit) add_circuit(run, out);
  add_layout(run, out);
  if (run.design.controller) add_controller(run, out);
  out.add("bode.csv", stages_csv(run));
  out.add("bode.svg", stages_svg(run.project, run.design, run.budget));
  return out;
}

}  // namespace bodesmith::project
