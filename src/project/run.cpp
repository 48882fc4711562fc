#include "project/run.hpp"

#include <algorithm>
#include <atomic>
#include <future>
#include <utility>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "project/alternative_hardware.hpp"
#include "project/analog_controller.hpp"
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

/// Stands in the folder from the design's files to the last ones.
constexpr const char* kUnfinished = "UNFINISHED.txt";

void add_unfinished(OutputSet& out) {
  out.add(
      kUnfinished,
      "bodesmith run has not come to its end here. The design's files stand (cascade, sections, plan, netlists,\n"
      "layout); tracking.csv, tracking_stages.csv, report.html and run.json are missing, or those of a run before.\n"
      "The next run that ends takes this file away.\n");
}

/// What the disturbance alone decides: the analog controller, what its parts' errors do to it, and how the controllers as
/// built track on every stage. It is made beside the design.
class BesideDesign {
 public:
  explicit BesideDesign(const Project& project) : project_(project) {
    made_ = std::async(std::launch::async, [&project] { return make_analog_controller(project); }).share();
    part_errors_ = std::async(std::launch::async, [this] { return errors_of_parts(); });
    tracked_ = std::async(std::launch::async, [this] { return tracked(); });
  }
  ~BesideDesign() { unwanted_ = true; }
  BesideDesign(const BesideDesign&) = delete;
  BesideDesign& operator=(const BesideDesign&) = delete;

  const std::shared_future<AnalogControllerMade>& controller() const { return made_; }
  struct PartErrors {
    bool tried = false;
    std::optional<part_errors::Report> report;
  };
  PartErrors part_errors() { return part_errors_.get(); }
  ControllersTracked controllers() { return tracked_.get(); }

 private:
  PartErrors errors_of_parts() const {
    const auto controller = made_.get().controller;
    if (project_.deadline.passed() || unwanted_) return {};
    return {true, examine_controller(project_, controller)};
  }
  ControllersTracked tracked() const {
    const auto analog = made_.get().controller;
    if (unwanted_) return {};
    const auto controllers = built_controllers(project_, analog);
    BuiltControllers running;
    for (const auto& controller : controllers) running.push_back(controller.get());
    return track_controllers(project_, running);
  }

  const Project& project_;
  std::atomic<bool> unwanted_ = false;  ///< there is no design
  std::shared_future<AnalogControllerMade> made_;
  std::future<PartErrors> part_errors_;
  std::future<ControllersTracked> tracked_;
};

/// Each alternative's hardware, made one after the other beside whatever asks for one of them.
class HardwareBeside {
 public:
  explicit HardwareBeside(const Project& project) : project_(project) {}
  ~HardwareBeside() { unwanted_ = true; }
  HardwareBeside(const HardwareBeside&) = delete;
  HardwareBeside& operator=(const HardwareBeside&) = delete;

  void begin(const std::shared_ptr<AlternativeHardware>& hardware) {
    hardware_ = hardware;
    made_ = std::async(std::launch::async, [this] {
      for (std::size_t i = 0; i < hardware_->count(); ++i) {
        if (project_.deadline.passed() || unwanted_ || interrupted()) return;
        hardware_->of(i);
      }
    });
  }
  AlternativeHardware& hardware() { return *hardware_; }

 private:
  const Project& project_;
  std::atomic<bool> unwanted_ = false;
  std::shared_ptr<AlternativeHardware> hardware_;
  std::future<void> made_;
};

/// What needs the design: its circuit in ngspice, what the other alternatives become, and its files.
class BesideTracking {
 public:
  BesideTracking(ProjectRun& run, AlternativeHardware& hardware) {
    if (run.design.circuit && spice::ngspice_available()) {
      check_ = std::async(std::launch::async, [&run] {
        return spice::check_compensator(run.design.circuit->circuit, run.design.sections());
      });
    }
    alternatives_ = std::async(std::launch::async, [&run, &hardware] {
      return study_alternatives(run.project, run.design, hardware);
    });
  }

  std::optional<spice::CompensatorCheck> check() {
    if (!check_.valid()) return std::nullopt;
    return check_.get();
  }
  std::vector<AlternativeStudy> alternatives() { return alternatives_.get(); }

 private:
  std::future<spice::CompensatorCheck> check_;
  std::future<std::vector<AlternativeStudy>> alternatives_;
};

/// A refused design, as an error that names the project file.
Design design_of(const Project& project, const fs::path& project_file, const BesideDesign& beside,
                 HardwareBeside& alternatives) {
  try {
    return make_design(project, beside.controller(),
                       [&alternatives](const std::shared_ptr<AlternativeHardware>& hardware) {
                         alternatives.begin(hardware);
                       });
  } catch (const DesignError& error) {
    throw DesignError(project_file.string() + ": " + error.what());
  }
}

/// The design's files, as soon as they are known; what was written.
std::vector<fs::path> write_design(ProjectRun& run, const fs::path& project_file, BesideDesign& beside,
                                   const fs::path& folder) {
  try {
    BesideDesign::PartErrors errors = beside.part_errors();
    run.part_errors = std::move(errors.report);
    if (!errors.tried) run.not_tried.emplace_back("errors of the controller's parts");
  } catch (const DesignError& error) {
    throw DesignError(project_file.string() + ": " + error.what());
  }
  OutputSet design = design_files(run, folder);
  std::vector<fs::path> out = design.paths();
  add_unfinished(design);
  design.commit();
  return out;
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

void write_study(ProjectRun& run, const fs::path& folder) {
  OutputSet out(folder);
  out.add("tracking.csv", tracking_csv(run.tracking));
  if (!run.tracking.elsewhere.empty()) out.add("tracking_stages.csv", tracking_stages_csv(run.tracking));
  out.add("report.html", report_page(run));
  for (const fs::path& path : out.paths()) run.files.push_back(path);
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
  BesideDesign beside(run.project);
  HardwareBeside alternatives(run.project);
  run.design = design_of(run.project, source.file, beside, alternatives);
  progress.at(0.1, 0.3, "parts and files");
  BesideTracking background(run, alternatives.hardware());
  run.budget = make_budget(run.project, run.design);
  run.limits = check_limits(run.project, run.design);
  auto written =
      std::async(std::launch::async, [&] { return write_design(run, source.file, beside, folder); });
  progress.at(0.3, 0.9, "tracking");
  run.tracking =
      study_tracking(run.project, run.design, run.budget, [&beside] { return beside.controllers(); });
  run.files = written.get();
  run.ngspice = background.check();
  stop_if_interrupted();
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
