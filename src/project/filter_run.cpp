#include "project/filter_run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "circuit/json.hpp"
#include "kicad/schematic.hpp"
#include "project/artefacts.hpp"
#include "spice/emit.hpp"
#include "yield/json.hpp"

namespace bodesmith::project {
namespace {
namespace fs = std::filesystem;

constexpr int kTableRows = 241;

std::string document(std::string_view schema, const FilterRun& run, const Json& body) {
  return artefact_json(schema, run.from, body, run.design.compute_s);
}

std::string bode_table(const FilterRun& run) {
  const Band& band = run.project.band;
  ResponseTable table(log_grid({Hertz{band.from.value / 2.0}, Hertz{band.to.value * 2.0}}, kTableRows));
  for (const FilterStage& stage : filter_stages(run.design)) table.add(stage.name, stage.response);
  return table.text();
}

void add_circuit_files(const FilterRun& run, OutputSet& out) {
  const circuit::Candidate& best = run.design.circuit->best;
  OutputSet spice;
  spice::add_spice_files(best.made, run.project.name, spice);
  kicad::add_kicad_files(best.made.circuit, run.project.name, spice);
  out.include("spice", spice);
  Json json = circuit::to_json(best.made);
  json["judged"] = circuit::to_json(best.judged);
  json["judged"]["band_hz"] = {best.judged_band.from.value, best.judged_band.to.value};
  json["shortfalls"] = best.shortfalls;
  out.add("spice/circuit.json", document("circuit", run, json));
}

Json tolerances_json(const FilterRun& run) {
  yield::Options options;
  options.limit_db = run.project.yield_db;
  return yield::to_json(*run.design.yield, options);
}

OutputSet filter_files(const FilterRun& run, const fs::path& folder) {
  OutputSet out(folder);
  if (run.design.fit) out.add("cascade.json", document("cascade", run, run.design.fit->to_json()));
  Json sections = run.design.sections.to_json();
  if (run.design.direct) sections["fit"] = run.design.direct->report_json();
  if (run.design.approximation) sections["approximation"] = run.design.approximation->report_json();
  out.add("sections.json", document("sections", run, sections));
  if (const auto& plan = run.design.plan)
    add_board_files(*plan, document("fpaa_plan", run, plan->to_json()), out);
  if (run.design.circuit) add_circuit_files(run, out);
  if (run.design.yield)
    out.add("yield.json", document("yield", run, {{"designs", Json::array({tolerances_json(run)})}}));
  out.add("bode.csv", bode_table(run));
  out.add("bode.svg", filter_svg(run));
  out.add("report.html", filter_page(run));
  return out;
}

}  // namespace

bool FilterRun::limits_met() const {
  const bool met =
      std::all_of(limits.begin(), limits.end(), [](const LimitCheck& check) { return check.met(); });
  return met && design.no_plan.empty() && (!design.circuit || design.circuit->best.shortfalls.empty());
}

FilterRun run_filter_project(const ProjectSource& source, const fs::path& folder) {
  const Stopwatch watch;
  Progress progress("run");
  progress.at(0.0, 0.9, "design");
  FilterRun run;
  run.from = source.from;
  run.project = FilterProject::from_document(source.document, source.file, run.from);
  run.project.deadline = source.deadline;
  try {
    run.design = make_filter_design(run.project);
  } catch (const DesignError& error) {
    throw DesignError(source.file.string() + ": " + error.what());
  }
  progress.at(0.9, 1.0, "netlists and report");
  run.limits = check_filter_limits(run.project, run.design);
  OutputSet out = filter_files(run, folder);
  for (const fs::path& path : out.paths()) run.files.push_back(path);
  run.files.emplace_back("run.json");
  run.compute_s = watch.seconds();
  Json json = json_header("run", run.from);
  json.update(filter_json(run));
  out.add("run.json", to_text(json));
  out.commit();
  return run;
}

std::string filter_summary(const FilterRun& run) {
  const FilterDesign& design = run.design;
  const std::string band = fmt::format("{} to {}", engineering_text(run.project.band.from.value, "Hz", 4),
                                       engineering_text(run.project.band.to.value, "Hz", 4));
  std::string out = fmt::format("{}\ntarget     {}, {}\n           {}\n", run.project.name,
                                run.project.target_file, band, design.how);
  if (run.project.sections) {
    out += fmt::format("sections   {} poles\n", design.sections.pole_count());
  } else {
    out += fmt::format("sections   {} poles, {} dB from the target\n", design.sections.pole_count(),
                       rounded_text(design.target_db, 3));
  }
  if (design.plan) {
    const fpaa::PlanError& runs = design.plan->error_with_delays;
    out += fmt::format("fpaa       {} CAMs, {} % as the board runs\n", design.plan->cams().size(),
                       rounded_text(runs.max_complex_percent, 3));
  } else if (!design.no_plan.empty()) {
    out += "fpaa       NOT made: " + design.no_plan + "\n";
  }
  if (design.circuit) {
    const circuit::Candidate& best = design.circuit->best;
    out += fmt::format("circuit    {}, {} op-amps, {} dB with parts and op-amps\n", best.how,
                       best.made.circuit.opamps.size(), rounded_text(best.judged.max_magnitude_db, 3));
    for (const std::string& shortfall : best.shortfalls) out += "           NOT met: " + shortfall + "\n";
  }
  if (design.yield) {
    out += fmt::format("tolerances 95 of 100 circuits within {} dB ({} % resistors, {} % capacitors)\n",
                       rounded_text(design.yield->worst_db.quantile(0.95), 3),
                       rounded_text(run.project.spread.resistor_percent),
                       rounded_text(run.project.spread.capacitor_percent));
  }
  for (const LimitCheck& check : run.limits) {
    out += fmt::format("limit      {} {}: {} {}\n", check.name, rounded_text(check.limit),
                       rounded_text(check.got, 3), check.met() ? "met" : "NOT met");
  }
  for (const std::string& one : design.not_tried) out += "not tried  " + one + "\n";
  return out + "report     report.html\n";
}

Json filter_json(const FilterRun& run) {
  const FilterDesign& design = run.design;
  Json out;
  out["name"] = run.project.name;
  out["target"] = run.project.target_file;
  out["band_hz"] = {run.project.band.from.value, run.project.band.to.value};
  out["how"] = design.how;
  out["poles"] = design.sections.pole_count();
  if (!run.project.sections) out["target_db"] = design.target_db;
  if (design.plan) out["fpaa_percent"] = design.plan->error_with_delays.max_complex_percent;
  if (!design.no_plan.empty()) out["no_plan"] = design.no_plan;
  if (design.circuit) {
    out["circuit"] = {{"realization", design.circuit->best.realisation},
                      {"error", circuit::to_json(design.circuit->best.judged)},
                      {"shortfalls", design.circuit->best.shortfalls},
                      {"passed_over", design.circuit->passed_over}};
  }
  out["not_tried"] = design.not_tried;
  if (design.yield) out["yield_db"] = design.yield->worst_db.quantile(0.95);
  out["limits"] = Json::array();
  for (const LimitCheck& check : run.limits)
    out["limits"].push_back(
        {{"name", check.name}, {"limit", check.limit}, {"got", check.got}, {"met", check.met()}});
  out["files"] = Json::array();
  for (const fs::path& path : run.files) out["files"].push_back(path.string());
  out["timing_s"] = {{"compute", run.compute_s}, {"design", design.compute_s}};
  return out;
}

}  // namespace bodesmith::project
