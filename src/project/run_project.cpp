#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/progress.hpp"
#include "project/design/alternative_hardware.hpp"
#include "project/design/controllers.hpp"
#include "project/design/target_fit.hpp"
#include "project/output/run_files.hpp"
#include "project/run.hpp"
#include "project/stages.hpp"
#include "project/tracking/engines.hpp"
#include "project/tracking/follow_designs.hpp"
#include "project/tracking/tracked_plant.hpp"
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
void write_design(Run& run, const fs::path& folder) {
  OutputSet design = design_files(run, folder);
  run.files = design.paths();
  add_unfinished(design);
  design.commit();
}

void say_what_was_left(Run& run) {
  run.not_tried.insert(run.not_tried.end(), run.design.not_tried.begin(), run.design.not_tried.end());
  if (!run.project.plant || !run.project.deadline.passed()) return;
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
void write_last(Run& run, const fs::path& folder) {
  OutputSet out(folder);
  if (run.project.plant) {
    out.add("tracking.csv", tracking_csv(run.tracking));
    if (!run.tracking.elsewhere.empty()) out.add("tracking_stages.csv", tracking_stages_csv(run.tracking));
  }
  out.add("report.html", report_page(run));
  if (run.project.plant) out.add("summary.txt", run.tables());
  for (const fs::path& path : out.paths()) run.files.push_back(path);
  run.files.emplace_back("run.json");
  Json json = json_header("run", run.from);
  json.update(run.json());
  out.add("run.json", to_text(json));
  out.commit();
}

}  // namespace

Run run_project(const ProjectSource& source, const fs::path& folder) {
  const Stopwatch watch;
  Progress progress("run");
  progress.at(0.0, 0.1, "design");
  Run run;
  run.from = source.from;
  run.project = source.project(run.from);
  const Project& project = run.project;
  std::optional<AlternativeHardware> hardware;
  AnalogControllerMade analog;
  ControllersTracked controllers;
  std::vector<TrackedCandidate> candidates;
  std::vector<std::string> unsettled;
  tracking::Report followed;
  CircuitTracked circuit;
  std::vector<BoardsInTime> boards(2);
  std::vector<TrackedElsewhere> elsewhere;

  Stages stages;
  /// A stage that only a project with a plant has.
  const auto with_plant = [&](std::vector<Stages::Stage> needs, std::function<void()> work) {
    return stages.add(
        std::move(needs), project.plant ? std::move(work) : [] {});
  };
  // What the disturbance alone decides.
  const auto controller = with_plant({}, [&] { analog = make_analog_controller(project); });
  const auto part_errors = with_plant({controller}, [&] {
    if (project.deadline.passed()) {
      run.not_tried.emplace_back("errors of the controller's parts");
    } else {
      run.part_errors = examine_controller(project, analog.controller);
    }
  });
  const auto controllers_tracked =
      with_plant({controller}, [&] { controllers = track_built_controllers(project, analog.controller); });
  // The design.
  const auto fitted = stages.add({}, [&] {
    run.design = project.plant ? fit_stage(project) : fit_response(project);
    hardware.emplace(project, run.design.fit, run.design.alternatives);
  });
  const auto chosen = stages.add({fitted}, [&] { choose_alternative(project, *hardware, run.design); });
  const auto tolerances = stages.add({fitted}, [&] {
    if (!project.plant) add_tolerances(project, *hardware, run.design);
  });
  const auto design = with_plant({chosen, controller}, [&] {
    add_controller(analog, run.design);
    run.budget = make_budget(project, run.design);
    candidates = tracked_candidates(project, run.design);
    unsettled = take_out_unsettled(tracking_plant(project), tracking_options(project), candidates);
    progress.at(0.3, 0.9, "tracking");
  });
  const auto files =
      stages.add({chosen, design, tolerances, part_errors}, [&] { write_design(run, folder); });
  // What becomes of it.
  const auto ngspice = with_plant({design}, [&] {
    if (run.design.circuit && ngspice::is_available())
      run.ngspice = synthesis::check_compensator(run.design.realised().circuit, run.design.sections());
  });
  const auto studies = with_plant(
      {design}, [&] { run.alternatives = study_alternatives(project, run.design, run.budget, *hardware); });
  const Stopwatch tracking_watch;
  const auto here = with_plant({design}, [&] { followed = follow_designs(project, candidates); });
  const auto simulated =
      with_plant({design}, [&] { circuit = track_circuit(project, run.design, candidates); });
  const auto clocked =
      with_plant({design}, [&] { boards[0] = track_board_in_time(project, run.design, candidates); });
  const auto clocked_controller = with_plant({controllers_tracked}, [&] {
    if (!project.deadline.passed()) boards[1] = track_board_controller_in_time(project, controllers.here);
  });
  const auto there = with_plant({design, controllers_tracked}, [&] {
    if (!project.deadline.passed()) elsewhere = tracked_elsewhere(project, candidates, controllers);
  });
  const auto study = with_plant({here, clocked, clocked_controller, simulated, there}, [&] {
    run.tracking = tracking_study(project, run.design, run.budget, candidates, followed, controllers,
                                  std::move(elsewhere));
    run.tracking.engines = engine_rows(run.tracking, followed, circuit, boards);
    std::ranges::copy(unsettled, std::back_inserter(run.tracking.findings));
    std::ranges::copy(engine_warnings(run.tracking.engines), std::back_inserter(run.tracking.findings));
    run.tracking.compute_s = tracking_watch.seconds();
  });
  stages.add({files, ngspice, studies, study}, [&] {
    stop_if_interrupted();
    progress.at(0.9, 1.0, "report");
    run.limits = check_limits(project, run.design, run.tracking);
    say_what_was_left(run);
    run.compute_s = watch.seconds();
    write_last(run, folder);
  });
  try {
    stages.run();
  } catch (const DesignError& error) {
    throw DesignError(source.file.string() + ": " + error.what());
  }
  std::error_code ignored;
  fs::remove(folder / kUnfinished, ignored);
  return run;
}

}  // namespace bodesmith::project
