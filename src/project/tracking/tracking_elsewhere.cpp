#include "project/tracking/tracking_elsewhere.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "fpaa/controller/controller.hpp"
#include "hysteresis/model_type.hpp"
#include "numeric/parallel_for.hpp"
#include "project/design/board_controller.hpp"
#include "project/output/run_model.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "signal/statistics.hpp"
#include "synthesis/controller/circuit_controller.hpp"
#include "tracking/track.hpp"

namespace bodesmith::project {
namespace {

using tracking::Reference;
using tracking::Stage;

/// What is followed elsewhere: one of each way of compensating.
bool followed_elsewhere(const TrackedCandidate& candidate) {
  for (const std::string_view key :
       {tracked::none, tracked::polynomial, tracked::cascade, tracked::two_passes_scheduled,
        tracked::self_fed, tracked::self_fed_sections, tracked::self_fed_scheduled, tracked::self_fed_slope})
    if (candidate.key == key) return true;
  return false;
}

void append(const tracking::TrackingError& error, TrackedDesign& to) {
  to.rms_percent.push_back(error.rms_percent);
  to.max_percent.push_back(error.max_percent);
  to.rms_percent_without_lag.push_back(error.rms_percent_without_lag);
  to.lag_s.push_back(error.lag_s);
}

/// One controller on one stage along one reference, all frequencies.
TrackedDesign controller_on(const ControllerDrives& controller, const Stage& stage, Reference::Shape shape,
                            double amplitude, const std::vector<Hertz>& frequencies) {
  TrackedDesign out;
  out.key = controller.controller->key();
  out.name = controller.controller->name();
  out.built = true;
  out.parts = controller.controller->part_count();
  for (const Hertz f : frequencies) {
    const ControllerDrives::One& one = *controller.find(shape, amplitude, f);
    const std::vector<double>& v = one.drive.v;
    const double repeat = static_cast<double>(one.reference.periods()) / f.value;
    const double repeats =
        std::max(1.0, std::round(static_cast<double>(v.size()) * one.drive.step_s / repeat));
    const auto samples = static_cast<std::size_t>(static_cast<double>(v.size()) / repeats);
    append(tracking::tracking_error(stage.response(v, one.drive.step_s, f), one.reference.samples(samples),
                                    repeat),
           out);
  }
  return out;
}

/// The ideal ways of compensating, without the built controllers.
TrackedElsewhere followed(const Project& project, const ElsewhereTask& task,
                          const std::vector<TrackedCandidate>& candidates) {
  TrackedElsewhere out{task.name, task.waveform, task.amplitude, {}, {}};
  tracking::Plant plant = tracking_plant(project);
  plant.stage = task.stage;
  tracking::Options options = tracking_options(project);
  options.reference = task.waveform;
  options.alpha = task.amplitude;
  options.time_domain = false;
  options.harmonics = 2048;
  std::vector<tracking::Design> designs;
  for (const TrackedCandidate& candidate : candidates)
    if (followed_elsewhere(candidate)) designs.push_back(candidate.design);
  const tracking::Report report = tracking::track(plant, designs, options);
  for (const TrackedCandidate& candidate : candidates) {
    if (!followed_elsewhere(candidate)) continue;
    TrackedDesign design;
    design.key = candidate.key;
    design.name = candidate.design.name;
    for (const Hertz f : options.frequencies) {
      const tracking::Case* found = report.find(f, design.name);
      append({found->rms_percent, found->max_percent, 0.0, found->lag_s, found->rms_percent_without_lag},
             design);
    }
    out.designs.push_back(std::move(design));
  }
  if (task.identified != nullptr) {
    for (const Hertz f : options.frequencies)
      out.fit_percent.push_back(task.identified->fit(f).full_stroke_percent);
  }
  return out;
}

std::vector<ElsewhereTask> all_tasks(const Project& project) {
  const tracking::Plant plant = tracking_plant(project);
  struct Family {
    const char* name;
    int size;
  };
  // 40 levels of a Preisach plane follow the loops as closely as the polynomials are known; the others' own sizes,
  // Prandtl-Ishlinskii with dead zones, as the branches differ.
  constexpr Family kFamilies[] = {{"preisach", 40}, {"prandtl_ishlinskii", 0}, {"bouc_wen", 0}};
  std::vector<std::shared_ptr<const tracking::IdentifiedStage>> families;
  for (const Family& family : kFamilies) {
    tracking::IdentifiedStage::Options options;
    options.identify.size = family.size;
    options.identify.asymmetric = true;
    families.push_back(std::make_shared<tracking::IdentifiedStage>(
        hysteresis::model_type_registry().get(family.name), plant.disturbance, plant.paths(), options));
  }
  std::vector<ElsewhereTask> out;
  for (const Reference::Shape waveform : project.track.waveforms) {
    for (const double amplitude : project.track.amplitudes) {
      const bool main = waveform == project.track.waveform() && amplitude == project.track.amplitude();
      tracking::PolynomialStage::Options options;
      options.alpha = amplitude;
      if (!main) {
        out.push_back({"polynomial",
                       std::make_shared<tracking::PolynomialStage>(plant.disturbance, plant.paths(), options),
                       nullptr, waveform, amplitude});
        options.rule = tracking::PolynomialStage::Rule::nested;
        out.push_back({"polynomial_nested",
                       std::make_shared<tracking::PolynomialStage>(plant.disturbance, plant.paths(), options),
                       nullptr, waveform, amplitude});
      }
      for (const auto& family : families)
        out.push_back({family->name(), family, family.get(), waveform, amplitude});
    }
  }
  return out;
}

/// The controller on the board fed by its own drive, in every way to make the polynomials that fits.
void add_board_controllers(const Project& project,
                           std::vector<std::unique_ptr<tracking::BuiltController>>& out) {
  fpaa::ControllerOptions options;
  options.board = project.fpaa->board;
  const Disturbance& disturbance = project.target.disturbance;
  const auto made = fpaa::make_controller(disturbance, nullptr, nullptr, options);
  const auto* board = std::get_if<fpaa::Controller>(&made);
  if (board == nullptr) return;
  for (const fpaa::ControllerVariant& variant : board->variants) {
    if (!variant.fits() || variant.structure != fpaa::ControllerStructure::loop) continue;
    out.push_back(std::make_unique<BoardController>(variant, disturbance));
  }
}

/// Every controller of the project that can be run here: the analog one where there is one and ngspice is installed; where
/// tracking decides, those of the board, fed by their own drive.
std::vector<std::unique_ptr<tracking::BuiltController>> built_controllers(
    const Project& project, const std::shared_ptr<const controller::AnalogController>& analog) {
  std::vector<std::unique_ptr<tracking::BuiltController>> out;
  if (project.circuit && analog && ngspice::is_available())
    out.push_back(std::make_unique<controller::CircuitController>(analog, controller::NgspiceRun::of_many()));
  if (project.fpaa && project.choice == Project::Choice::tracking) add_board_controllers(project, out);
  return out;
}

}  // namespace

const ControllerDrives::One* ControllerDrives::find(Reference::Shape shape, double amplitude,
                                                    Hertz operating) const {
  const auto found = std::find_if(drives.begin(), drives.end(), [&](const One& one) {
    return one.reference.shape() == shape && one.reference.alpha() == amplitude && one.operating == operating;
  });
  return found == drives.end() ? nullptr : &*found;
}

std::vector<ControllerDrives> controller_drives(const Project& project, const BuiltControllers& controllers) {
  std::vector<ControllerDrives> out;
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (const tracking::BuiltController* controller : controllers) {
    ControllerDrives& drives = out.emplace_back();
    drives.controller = controller;
    for (const Reference::Shape waveform : project.track.waveforms) {
      for (const double amplitude : project.track.amplitudes) {
        for (const Hertz f : project.track.frequency) {
          all.emplace_back(out.size() - 1, drives.drives.size());
          drives.drives.push_back({Reference(waveform, amplitude), f, {}});
        }
      }
    }
  }
  parallel_for(all.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    ControllerDrives& drives = out[all[i].first];
    ControllerDrives::One& one = drives.drives[all[i].second];
    one.drive = drives.controller->drive(one.reference, one.operating);
  });
  stop_if_interrupted();
  return out;
}

ControllersTracked track_controllers(const Project& project, const BuiltControllers& controllers) {
  const std::vector<ControllerDrives> drives = controller_drives(project, controllers);
  const tracking::PolynomialStage own = own_stage(project);
  ControllersTracked out;
  out.here.resize(drives.size());
  if (!project.deadline.passed()) out.tasks = all_tasks(project);
  const std::size_t count = out.tasks.size();
  out.elsewhere.assign(count, std::vector<TrackedDesign>(drives.size()));
  // The families' stages first: they are identified where they are first asked.
  parallel_for((count + 1) * drives.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    const std::size_t c = i / (count + 1), t = i % (count + 1);
    if (t == count) {
      out.here[c] = controller_on(drives[c], own, project.track.waveform(), project.track.amplitude(),
                                  project.track.frequency);
    } else {
      const ElsewhereTask& task = out.tasks[t];
      out.elsewhere[t][c] =
          controller_on(drives[c], *task.stage, task.waveform, task.amplitude, project.track.frequency);
    }
  });
  out.drives = drives;
  return out;
}

namespace {

/// The netlist by CVODE and at rest beside what ngspice makes of it, which stands for what is built where it is installed.
void add_checks(const Project& project, const std::shared_ptr<const controller::AnalogController>& analog,
                ControllersTracked& out) {
  const controller::CircuitController in_time(analog, std::nullopt);
  const auto at_rest = controller_at_rest(project, analog);
  const Reference::Shape shape = project.track.waveform();
  const double amplitude = project.track.amplitude();
  std::vector<ControllerDrives> checks = {{&in_time, {}}, {at_rest.get(), {}}};
  for (ControllerDrives& one : checks) {
    for (const Hertz f : project.track.frequency) one.drives.push_back({Reference(shape, amplitude), f, {}});
  }
  const std::size_t count = project.track.frequency.size();
  parallel_for(2 * count, thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    ControllerDrives::One& one = checks[i / count].drives[i % count];
    one.drive = checks[i / count].controller->drive(one.reference, one.operating);
  });
  const bool ngspice = ngspice::is_available();
  const tracking::PolynomialStage own = own_stage(project);
  for (const ControllerDrives& one : checks) {
    out.here.push_back(controller_on(one, own, shape, amplitude, project.track.frequency));
    out.here.back().built = !ngspice && &one == checks.data();
  }
  for (const ControllerDrives::One& one : checks.front().drives) {
    if (!ngspice) break;
    const auto& v = out.drives.front().find(shape, amplitude, one.operating)->drive.v;
    out.agreement_percent =
        std::max(out.agreement_percent.value_or(0.0), 100.0 * error_figures(one.drive.v, v).rms / amplitude);
  }
}

}  // namespace

ControllersTracked track_built_controllers(
    const Project& project, const std::shared_ptr<const controller::AnalogController>& analog) {
  const auto controllers = built_controllers(project, analog);
  BuiltControllers running;
  for (const auto& controller : controllers) running.push_back(controller.get());
  ControllersTracked out = track_controllers(project, running);
  if (project.circuit && analog) add_checks(project, analog, out);
  out.drives.clear();  // they refer to controllers that end here
  return out;
}

std::vector<TrackedElsewhere> tracked_elsewhere(const Project& project,
                                                const std::vector<TrackedCandidate>& candidates,
                                                const ControllersTracked& controllers) {
  std::vector<TrackedElsewhere> out(controllers.tasks.size());
  parallel_for(out.size(), thread_count(0),
               [&](std::size_t i) { out[i] = followed(project, controllers.tasks[i], candidates); });
  for (std::size_t i = 0; i < out.size(); ++i)
    for (const TrackedDesign& design : controllers.elsewhere[i]) out[i].designs.push_back(design);
  return out;
}

}  // namespace bodesmith::project
