#include "project/run_project.hpp"

#include <optional>
#include <utility>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "project/design/alternative_hardware.hpp"
#include "project/design/controllers.hpp"
#include "project/output/run_files.hpp"
#include "project/report/report_page.hpp"
#include "project/stages.hpp"
#include "project/tracking/engines.hpp"
#include "project/tracking/follow_designs.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith::project {
namespace {
namespace fs = std::filesystem;

/// Stands in the folder from the design's files to the last ones.
constexpr const char* kUnfinished = "UNFINISHED.txt";

void add_unfinished(OutputSet& out) {
  out.add(
      kUnfinished,
      "bodesmith run has not come to its end here. The design's files stand (cascade, sections, plan, netlists,\n"
      "layout); tracking.csv, tracking_stages.csv, report.html and run.json are missing, or those of a run before.\n"
      "The next run that ends takes this file away.\n");
}

/// The design's files, as soon as they are known.
void write_design(ProjectRun& run, const fs::path& folder) {
  OutputSet design = design_files(run, folder);
  run.files = design.paths();
  add_unfinished(design);
  design.commit();
}

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

/// The last files of a run, and run.json, which names all of them.
void write_last(Run& run, OutputSet out) {
  for (const fs::path& path : out.paths()) run.files.push_back(path);
  run.files.emplace_back("run.json");
  Json json = json_header("run", run.from);
  json.update(run.json());
  out.add("run.json", to_text(json));
  out.commit();
}

OutputSet study_files(const ProjectRun& run, const fs::path& folder) {
  OutputSet out(folder);
  out.add("tracking.csv", tracking_csv(run.tracking));
  if (!run.tracking.elsewhere.empty()) out.add("tracking_stages.csv", tracking_stages_csv(run.tracking));
  out.add("report.html", report_page(run));
  out.add("summary.txt", run.tables());
  return out;
}

/// All stages; a refused design as an error that names the project file.
void run_stages(Stages& stages, const fs::path& project_file) {
  try {
    stages.run();
  } catch (const DesignError& error) {
    throw DesignError(project_file.string() + ": " + error.what());
  }
}

/// A run whose project is read, nothing done yet.
template <class Kind>
std::unique_ptr<Kind> begun(const ProjectSource& source) {
  auto out = std::make_unique<Kind>();
  out->from = source.from;
  out->project = decltype(out->project)::from_document(source.document, source.file, out->from);
  out->project.deadline = source.deadline;
  return out;
}

std::unique_ptr<Run> run_with_plant(const ProjectSource& source, const fs::path& folder) {
  const Stopwatch watch;
  Progress progress("run");
  progress.at(0.0, 0.1, "design");
  auto out = begun<ProjectRun>(source);
  ProjectRun& run = *out;
  const Project& project = run.project;
  AnalogControllerMade analog;
  ControllersTracked controllers;
  std::optional<AlternativeHardware> hardware;
  std::vector<TrackedCandidate> candidates;
  tracking::Report followed;
  CircuitTracked circuit;
  BoardsInTime board;
  std::vector<TrackedElsewhere> elsewhere;

  Stages stages;
  // What the disturbance alone decides.
  const auto controller = stages.add({}, [&] { analog = make_analog_controller(project); });
  const auto part_errors = stages.add({controller}, [&] {
    if (project.deadline.passed()) {
      run.not_tried.emplace_back("errors of the controller's parts");
    } else {
      run.part_errors = examine_controller(project, analog.controller);
    }
  });
  const auto controllers_tracked =
      stages.add({controller}, [&] { controllers = track_built_controllers(project, analog.controller); });
  // The design.
  const auto alternatives = stages.add({}, [&] {
    run.design = make_alternative_designs(project);
    hardware.emplace(project, run.design.fit.cascade, run.design.alternatives);
  });
  const auto chosen = stages.add({alternatives}, [&] { choose_alternative(project, *hardware, run.design); });
  const auto design = stages.add({chosen, controller}, [&] {
    add_controller(analog, run.design);
    run.budget = make_budget(project, run.design);
    candidates = tracked_candidates(project, run.design);
    progress.at(0.3, 0.9, "tracking");
  });
  const auto files = stages.add({design, part_errors}, [&] { write_design(run, folder); });
  // What becomes of it.
  const auto ngspice = stages.add({design}, [&] {
    if (run.design.circuit && ngspice::is_available())
      run.ngspice = synthesis::check_compensator(run.design.realised().circuit, run.design.sections());
  });
  const auto studies =
      stages.add({design}, [&] { run.alternatives = study_alternatives(project, run.design, *hardware); });
  const Stopwatch tracking_watch;
  const auto here = stages.add({design}, [&] { followed = follow_designs(project, candidates); });
  const auto simulated =
      stages.add({design}, [&] { circuit = track_circuit(project, run.design, candidates); });
  const auto clocked =
      stages.add({here}, [&] { board = track_board_in_time(project, run.design, candidates, followed); });
  const auto there = stages.add({design, controllers_tracked}, [&] {
    if (!project.deadline.passed()) elsewhere = tracked_elsewhere(project, candidates, controllers);
  });
  stages.add({clocked, simulated, there, files, ngspice, studies}, [&] {
    stop_if_interrupted();
    progress.at(0.9, 1.0, "report");
    run.tracking = tracking_study(project, run.design, run.budget, candidates, followed, controllers,
                                  std::move(elsewhere));
    run.tracking.engines = engine_rows(run.tracking, followed, circuit, board);
    run.tracking.compute_s = tracking_watch.seconds();
    run.limits = check_limits(project, run.design, run.tracking);
    say_what_was_left(run);
    run.compute_s = watch.seconds();
    write_last(run, study_files(run, folder));
  });
  run_stages(stages, source.file);
  std::error_code ignored;
  fs::remove(folder / kUnfinished, ignored);
  return out;
}

std::unique_ptr<Run> run_filter(const ProjectSource& source, const fs::path& folder) {
  const Stopwatch watch;
  Progress progress("run");
  progress.at(0.0, 0.9, "design");
  auto out = begun<FilterRun>(source);
  FilterRun& run = *out;

  Stages stages;
  const auto sections = stages.add({}, [&] { add_sections(run.project, run.design); });
  const auto plan = stages.add({sections}, [&] { add_plan(run.project, run.design); });
  const auto circuit = stages.add({sections}, [&] { add_circuit(run.project, run.design); });
  const auto tolerances = stages.add({circuit}, [&] { add_tolerances(run.project, run.design); });
  stages.add({plan, tolerances}, [&] {
    stop_if_interrupted();
    progress.at(0.9, 1.0, "netlists and report");
    run.design.compute_s = watch.seconds();
    run.not_tried = run.design.not_tried;
    run.limits = check_limits(run.project, run.design);
    run.compute_s = watch.seconds();
    write_last(run, filter_files(run, folder));
  });
  run_stages(stages, source.file);
  return out;
}

}  // namespace

std::unique_ptr<Run> run_project(const ProjectSource& source, const fs::path& folder) {
  return source.is_filter() ? run_filter(source, folder) : run_with_plant(source, folder);
}

void check_project(const ProjectSource& source) {
  Provenance from;
  if (source.is_filter()) {
    FilterProject::from_document(source.document, source.file, from);
  } else {
    Project::from_document(source.document, source.file, from);
  }
}

}  // namespace bodesmith::project
