#include "project/run.hpp"

#include <algorithm>
#include <future>

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
#include "project/tracking_elsewhere.hpp"
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

/// Stands in the folder from the design's files to the last ones.
constexpr const char* kUnfinished = "UNFINISHED.txt";

void add_unfinished(OutputSet& out) {
  out.add(
      kUnfinished,
      "bodesmith run has not come to its end here. The design's files stand (cascade, sections, plan, netlists,\n"
      "layout); tracking.csv, tracking_stages.csv, report.html and run.json are missing, or those of a run before.\n"
      "The next run that ends takes this file away.\n");
}

/// What runs in ngspice and on the board's simulation, and what the other alternatives become, needs the design alone: it is
/// made beside everything else.
class Background {
 public:
  explicit Background(const ProjectRun& run) : controllers_(built_controllers(run.project, run.design)) {
    if (run.design.circuit && spice::ngspice_available()) {
      check_ = std::async(std::launch::async, [&run] {
        return spice::check_compensator(run.design.circuit->circuit, run.design.sections());
      });
    }
    alternatives_ =
        std::async(std::launch::async, [&run] { return study_alternatives(run.project, run.design); });
    drives_ = std::async(std::launch::async, [this, &run] {
      BuiltControllers running;
      for (const auto& controller : controllers_) running.push_back(controller.get());
      return controller_drives(run.project, running);
    });
  }

  std::optional<spice::CompensatorCheck> check() {
    if (!check_.valid()) return std::nullopt;
    return check_.get();
  }
  std::vector<ControllerDrives> drives() { return drives_.get(); }
  std::vector<AlternativeStudy> alternatives() { return alternatives_.get(); }

 private:
  std::vector<std::unique_ptr<tracking::BuiltController>> controllers_;
  std::future<spice::CompensatorCheck> check_;
  std::future<std::vector<ControllerDrives>> drives_;
  std::future<std::vector<AlternativeStudy>> alternatives_;
};

void say_what_was_left(ProjectRun& run) {
  if (!run.project.deadline.passed()) return;
  if (run.tracking.elsewhere.empty())
    run.not_tried.emplace_back("stages of other families, other references");
  for (std::size_t i = 0; i < run.alternatives.size(); ++i) {
    const Design& design = run.alternatives[i].design;
    if (i != run.design.chosen && run.project.circuit && !design.circuit &&
        !run.alternatives[i].refused.empty())
      run.not_tried.push_back("hardware of '" + run.design.alternatives[i].name + "'");
  }
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

ProjectRun run_project(const ProjectSource& source, const fs::path& folder) {
  const Stopwatch watch;
  Progress progress("run");
  progress.at(0.0, 0.1, "design");
  ProjectRun run;
  run.from = source.from;
  run.project = Project::from_document(source.document, source.file, run.from);
  run.project.deadline = source.deadline;
  run.design = design_of(run.project, source.file);
  progress.at(0.1, 0.2, "parts and files");
  Background background(run);
  run.budget = make_budget(run.project, run.design);
  run.limits = check_limits(run.project, run.design);
  if (run.project.deadline.passed()) {
    run.not_tried.emplace_back("errors of the controller's parts");
  } else {
    run.part_errors = errors_of_parts(run, source.file);
  }
  OutputSet design = design_files(run, folder);
  list_files(run, design);
  add_unfinished(design);
  design.commit();
  progress.at(0.2, 0.4, "netlists in ngspice");

  run.ngspice = background.check();
  stop_if_interrupted();
  progress.at(0.4, 0.9, "tracking");
  run.tracking =
      study_tracking(run.project, run.design, run.budget, [&background] { return background.drives(); });
  run.alternatives = background.alternatives();
  say_what_was_left(run);
  progress.at(0.9, 1.0, "report");
  run.compute_s = watch.seconds();
  write_study(run, folder);
  std::error_code ignored;
  fs::remove(folder / kUnfinished, ignored);
  return run;
}

}  // namespace bodesmith::project
