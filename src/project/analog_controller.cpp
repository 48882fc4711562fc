#include "project/analog_controller.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace bodesmith::project {
namespace {

using controller::Form;

controller::Options controller_options(const Project& project) {
  controller::Options options;
  options.resistors = circuit::Series::named(project.circuit->resistors);
  options.capacitors = circuit::Series::named(project.circuit->capacitors);
  options.tracked = project.track.frequency;
  options.reference_stroke = project.track.amplitude();
  options.lowest = *std::min_element(project.track.frequency.begin(), project.track.frequency.end());
  return options;
}

/// In the order in which they are tried.
std::vector<Form> forms_of(const Project& project) {
  if (project.controller.form) return {controller::form_named(*project.controller.form)};
  if (project.choice == Project::Choice::tracking) return {Form::self_fed, Form::two_pass, Form::one_pass};
  return {Form::one_pass};
}

}  // namespace

AnalogControllerMade make_analog_controller(const Project& project) {
  AnalogControllerMade out;
  if (!project.circuit) return out;
  controller::Options options = controller_options(project);
  for (const Form form : forms_of(project)) {
    options.form = form;
    try {
      out.controller = std::make_shared<const controller::AnalogController>(
          controller::make_controller(project.target.disturbance, options));
      return out;
    } catch (const DesignError& error) {
      if (project.controller.form) throw;
      out.passed_over.push_back("controller, " + std::string(to_string(form)) + ": " + error.what());
    }
  }
  return out;
}

}  // namespace bodesmith::project
