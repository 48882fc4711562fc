#include "project/design/controllers.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "synthesis/controller/as_built.hpp"
#include "tracking/reference.hpp"

namespace bodesmith::project {
namespace {

using generator::Form;

generator::Options controller_options(const Project& project) {
  generator::Options options(generator::Form::self_fed);
  options.resistors = synthesis::Series::named(project.circuit->resistors);
  options.capacitors = synthesis::Series::named(project.circuit->capacitors);
  options.tolerances = project.tolerances();
  options.tracked = project.track.frequency;
  options.reference_stroke = project.track.amplitude();
  for (const auto shape : project.track.waveforms) {
    for (const double amplitude : project.track.amplitudes)
      options.least_swing =
          std::min(options.least_swing, tracking::Reference(shape, amplitude).least_swing());
  }
  options.lowest = *std::ranges::min_element(project.track.frequency);
  return options;
}

/// In the order in which they are tried.
std::vector<Form> forms_of(const Project& project) {
  if (project.controller.form) return {generator::form_named(*project.controller.form)};
  if (project.choice == Project::Choice::tracking) return {Form::self_fed, Form::two_pass, Form::one_pass};
  return {Form::one_pass};
}

/// `yield controller` draws more.
constexpr std::uint64_t kCopies = 400;

}  // namespace

AnalogControllerMade make_analog_controller(const Project& project) {
  AnalogControllerMade out;
  if (!project.circuit) return out;
  generator::Options options = controller_options(project);
  const auto& strokes = project.track.amplitudes;
  options.full_stroke = std::ranges::all_of(strokes, [](double one) { return one == 1.0; });
  for (const Form form : forms_of(project)) {
    options.form = form;
    try {
      out.controller = std::make_shared<const generator::DisturbanceCircuit>(
          generator::make_controller(project.target.disturbance, options));
      for (const Hertz f : {options.lowest, std::ranges::max(options.tracked, {}, &Hertz::value)})
        if (out.controller->switched())
          generator::switch_delay_s(*out.controller, tracking::Reference(), f);  // refuses
      return out;
    } catch (const DesignError& error) {
      if (project.controller.form) throw;
      out.controller.reset();
      out.passed_over.push_back("controller, " + std::string(to_string(form)) + ": " + error.what());
    }
  }
  return out;
}

std::optional<tolerance::ControllerReport> examine_controller(
    const Project& project, const std::shared_ptr<const generator::DisturbanceCircuit>& controller) {
  if (!controller || project.track.frequency.empty()) return std::nullopt;
  const tracking::Plant plant = tracking_plant(project);
  const double stroke = tolerance::examined_stroke(*controller, project.track.amplitude());
  const tracking::PolynomialStage stage(plant.disturbance, plant.paths(), {.alpha = stroke});
  tolerance::ControllerReportOptions options;
  options.study.errors = project.controller.errors;
  options.study.reference = tracking::Reference(tracking::Reference::Shape::triangle, stroke);
  options.study.frequencies = project.track.frequency;
  std::ranges::sort(options.study.frequencies, {}, &Hertz::value);
  options.study.draws = options.trims.draws = kCopies;
  options.allow_unstable = project.controller.allow_unstable;
  return tolerance::examine(*controller, stage, options);
}

}  // namespace bodesmith::project
