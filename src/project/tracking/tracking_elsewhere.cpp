#include "project/tracking/tracking_elsewhere.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <utility>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "hysteresis/model_type.hpp"
#include "numeric/parallel_for.hpp"
#include "project/output/run_model.hpp"
#include "project/tracking/board_controller.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/controller/as_built.hpp"
#include "synthesis/controller/study.hpp"
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

/// The ideal ways of compensating, without the built controllers.
TrackedElsewhere followed(const Project& project, const ElsewhereTask& task,
                          const std::vector<TrackedCandidate>& candidates) {
  TrackedElsewhere out{task.name, task.reference.shape(), task.reference.alpha(), {}, {}};
  tracking::Plant plant = tracking_plant(project);
  plant.stage = task.stage;
  tracking::Options options = tracking_options(project);
  options.reference = out.waveform;
  options.alpha = out.amplitude;
  options.time_domain = false;
  options.harmonics = 2048;
  std::vector<TrackedCandidate> those;
  std::ranges::copy_if(candidates, std::back_inserter(those), followed_elsewhere);
  const auto report_of = [&] {
    std::vector<tracking::Design> designs;
    for (const TrackedCandidate& one : those) designs.push_back(one.design);
    return tracking::track(plant, designs, options);
  };
  tracking::Report report;
  try {
    report = report_of();
  } catch (const DesignError&) {  // along this reference some loop does not settle
    take_out_unsettled(plant, options, those);
    report = report_of();
  }
  for (const TrackedCandidate& one : those) {
    out.designs.push_back(tracked_design(one, options.frequencies, report));
    out.designs.back().built = false;  // what is built is told where it is chosen
  }
  if (task.identified != nullptr) {
    for (const Hertz f : options.frequencies) out.fit_percent.push_back(task.identified->fit_percent(f));
  }
  return out;
}

using ReferenceKey = std::pair<Reference::Shape, double>;
ReferenceKey key_of(const Reference& reference) {
  return {reference.shape(), reference.alpha()};
}

Reference main_reference(const Project& project) {
  return Reference(project.track.waveform(), project.track.amplitude());
}

/// Every waveform at every amplitude.
std::vector<Reference> references(const Project& project) {
  std::vector<Reference> out;
  for (const Reference::Shape waveform : project.track.waveforms)
    for (const double amplitude : project.track.amplitudes) out.emplace_back(waveform, amplitude);
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
  for (const Reference& reference : references(project)) {
    tracking::PolynomialStage::Options options;
    options.alpha = reference.alpha();
    const auto polynomial = [&] {
      return std::make_shared<tracking::PolynomialStage>(plant.disturbance, plant.paths(), options);
    };
    if (key_of(reference) != key_of(main_reference(project))) {
      out.push_back({"polynomial", polynomial(), nullptr, reference});
      options.rule = tracking::PolynomialStage::Rule::nested;
      out.push_back({"polynomial_nested", polynomial(), nullptr, reference});
    }
    for (const auto& family : families) out.push_back({family->name(), family, family.get(), reference});
  }
  return out;
}

/// A controller, and its drives along the references that it is asked for.
struct RunningController {
  std::unique_ptr<tracking::BuiltController> controller;
  bool built = true;       ///< stands for what is built
  bool everywhere = true;  ///< along all of the project's references; else along its first alone
  std::map<ReferenceKey, std::vector<tracking::DriveWaveform>> drives = {};  ///< one a frequency

  TrackedDesign on(const Stage& stage, const Reference& reference,
                   const std::vector<Hertz>& frequencies) const {
    TrackedDesign out =
        tracked_controller(*controller, stage, reference, frequencies, drives.at(key_of(reference)));
    out.built = built;
    return out;
  }
};

/// The analog controller first, in ngspice, which stands for what is built where it is installed; last by CVODE and at rest.
std::vector<RunningController> running_controllers(
    const Project& project, const std::shared_ptr<const generator::DisturbanceCircuit>& analog) {
  const bool ngspice = ngspice::is_available(), circuit = project.circuit && analog;
  std::vector<RunningController> out;
  if (circuit && ngspice)
    out.push_back({std::make_unique<generator::CircuitController>(analog, generator::NgspiceRun::of_many())});
  for (fpaa::ControllerVariant& variant : board_controllers(project))
    out.push_back({std::make_unique<BoardController>(std::move(variant), project.target.disturbance)});
  if (circuit) {
    out.push_back({std::make_unique<generator::CircuitController>(analog, std::nullopt), !ngspice, false});
    out.push_back({controller_at_rest(project, analog), false, false});
  }
  return out;
}

/// How far ngspice and CVODE are apart along the main reference (ControllersTracked::agreement_percent), where both run.
std::optional<double> make_drives(const Project& project, const generator::DisturbanceCircuit* analog,
                                  std::vector<RunningController>& controllers) {
  const std::vector<Hertz>& frequencies = project.track.frequency;
  const Reference main = main_reference(project);
  std::vector<std::function<void()>> all;
  RunningController *by_ngspice = nullptr, *by_cvode = nullptr;
  for (RunningController& one : controllers) {
    if (one.controller->key() == "controller_circuit") by_ngspice = &one;
    if (one.controller->key() == "controller_cvode") by_cvode = &one;
  }
  const bool both = by_ngspice != nullptr && by_cvode != nullptr;
  std::vector<double> apart(both ? frequencies.size() : 0);
  for (RunningController& one : controllers) {
    for (const Reference& reference : one.everywhere ? references(project) : std::vector{main}) {
      auto& drives = one.drives[key_of(reference)];
      drives.resize(frequencies.size());
      if (both && (&one == by_ngspice || &one == by_cvode) && key_of(reference) == key_of(main)) continue;
      for (std::size_t i = 0; i < frequencies.size(); ++i)
        all.emplace_back([&, reference, i] { drives[i] = one.controller->drive(reference, frequencies[i]); });
    }
  }
  for (std::size_t i = 0; i < apart.size(); ++i) {
    all.emplace_back([&, i] {
      auto [ngspice, cvode, percent] =
          generator::run_in_both(*analog, main, frequencies[i], generator::NgspiceRun::of_one(main));
      by_ngspice->drives[key_of(main)][i] = {std::move(ngspice.v), ngspice.step_s};
      by_cvode->drives[key_of(main)][i] = {std::move(cvode.v), cvode.step_s};
      apart[i] = percent;
    });
  }
  parallel_for(all.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    all[i]();
  });
  stop_if_interrupted();
  return apart.empty() ? std::nullopt : std::optional(std::ranges::max(apart));
}

}  // namespace

ControllersTracked track_built_controllers(
    const Project& project, const std::shared_ptr<const generator::DisturbanceCircuit>& analog) {
  std::vector<RunningController> controllers = running_controllers(project, analog);
  ControllersTracked out;
  out.agreement_percent = make_drives(project, analog.get(), controllers);
  const std::vector<Hertz>& frequencies = project.track.frequency;
  const Reference main = main_reference(project);
  const tracking::PolynomialStage own = own_stage(project);
  out.here.resize(controllers.size());
  if (!project.deadline.passed()) out.tasks = all_tasks(project);
  const std::size_t count = out.tasks.size();
  out.elsewhere.resize(count);
  for (std::vector<TrackedDesign>& row : out.elsewhere)
    row.resize(
        static_cast<std::size_t>(std::ranges::count(controllers, true, &RunningController::everywhere)));
  // The families' stages first: they are identified where they are first asked.
  parallel_for((count + 1) * controllers.size(), thread_count(0), [&](std::size_t i) {
    stop_if_interrupted();
    const std::size_t c = i / (count + 1), t = i % (count + 1);
    if (t == count) {
      out.here[c] = controllers[c].on(own, main, frequencies);
    } else if (controllers[c].everywhere) {
      out.elsewhere[t][c] = controllers[c].on(*out.tasks[t].stage, out.tasks[t].reference, frequencies);
    }
  });
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
