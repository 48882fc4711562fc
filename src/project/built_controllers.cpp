#include "project/built_controllers.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "controller/as_built.hpp"
#include "controller/controller.hpp"
#include "fpaa/controller.hpp"
#include "project/board_controller.hpp"
#include "spice/ngspice.hpp"

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

/// For a study of many references: at a four times finer step the drive differs by less than .001 % of range.
controller::NgspiceRun study_steps() {
  controller::NgspiceRun out;
  out.steps = 500;
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

}  // namespace

std::shared_ptr<const controller::AnalogController> make_analog_controller(
    const Project& project, std::vector<std::string>& passed_over) {
  if (!project.circuit) return nullptr;
  controller::Options options = controller_options(project);
  for (const Form form : forms_of(project)) {
    options.form = form;
    try {
      return std::make_shared<const controller::AnalogController>(
          controller::make_controller(project.target.disturbance, options));
    } catch (const DesignError& error) {
      if (project.controller.form) throw;
      passed_over.push_back("controller, " + std::string(to_string(form)) + ": " + error.what());
    }
  }
  return nullptr;
}

std::vector<std::unique_ptr<tracking::BuiltController>> built_controllers(const Project& project,
                                                                          const Design& design) {
  std::vector<std::unique_ptr<tracking::BuiltController>> out;
  if (project.circuit && design.controller && spice::ngspice_available())
    out.push_back(std::make_unique<controller::CircuitController>(design.controller, study_steps()));
  if (project.fpaa && project.choice == Project::Choice::tracking) add_board_controllers(project, out);
  return out;
}

}  // namespace bodesmith::project
