#include "project/run.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "project/built_controllers.hpp"
#include "project/controller_errors.hpp"
#include "project/report_page.hpp"
#include "project/run_files.hpp"
#include "project/run_summary.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::project {
namespace {
namespace fs = std::filesystem;

/// A refused design, as an error that names the project file.
Design design_of(const Project& project, const fs::path& project_file) {
  try {
    return make_design(project);
  } catch (const DesignError& error) {
    throw DesignError(project_file.string() + ": " + error.what());
  }
}

std::optional<part_errors::Report> errors_of_parts(const ProjectRun& run, const fs::path& project_file) {
  try {
    return examine_controller(run.project, run.design);
  } catch (const DesignError& error) {
    throw DesignError(project_file.string() + ": " + error.what());
  }
}

void list_files(ProjectRun& run, const OutputSet& out) {
  for (const fs::path& path : out.paths()) run.files.push_back(path);
}

void write_study(ProjectRun& run, const fs::path& folder) {
  OutputSet out(folder);
  out.add("tracking.csv", tracking_csv(run.tracking));
  if (!run.tracking.elsewhere.empty()) out.add("tracking_stages.csv", tracking_stages_csv(run.tracking));
  out.add("report.html", report_page(run));
  list_files(run, out);
  run.files.emplace_back("run.json");
  Json json = json_header("run", run.from);
  json.update(run_json(run));
  out.add("run.json", to_text(json));
  out.commit();
}

}  // namespace

bool ProjectRun::limits_met() const {
  return std::all_of(limits.begin(), limits.end(), [](const LimitCheck& check) { return check.met(); });
}

ProjectRun run_project(const fs::path& project_file, const fs::path& folder) {
  const Stopwatch watch;
  Progress progress("run");
  ProjectRun run;
  run.project = Project::read(project_file, run.from);
  run.design = design_of(run.project, project_file);
  progress.at(0.1);
  run.budget = make_budget(run.project, run.design);
  run.limits = check_limits(run.project, run.design);
  run.part_errors = errors_of_parts(run, project_file);
  OutputSet design = design_files(run, folder);
  design.commit();
  list_files(run, design);
  progress.at(0.2);

  if (run.design.circuit && spice::ngspice_available()) {
    run.ngspice = spice::check_compensator(run.design.circuit->circuit, run.design.sections());
  }
  stop_if_interrupted();
  progress.at(0.4);
  const auto controllers = built_controllers(run.project, run.design);
  BuiltControllers running;
  for (const auto& controller : controllers) running.push_back(controller.get());
  run.tracking = study_tracking(run.project, run.design, run.budget, running);
  progress.at(0.9);
  run.compute_s = watch.seconds();
  write_study(run, folder);
  return run;
}

}  // namespace bodesmith::project
