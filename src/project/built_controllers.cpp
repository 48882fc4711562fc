#include "project/built_controllers.hpp"

#include "controller/as_built.hpp"
#include "controller/controller.hpp"
#include "fpaa/controller.hpp"
#include "project/board_controller.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::project {
namespace {

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

std::vector<std::unique_ptr<tracking::BuiltController>> built_controllers(
    const Project& project, const std::shared_ptr<const controller::AnalogController>& analog) {
  std::vector<std::unique_ptr<tracking::BuiltController>> out;
  if (project.circuit && analog && spice::ngspice_available())
    out.push_back(std::make_unique<controller::CircuitController>(analog, controller::NgspiceRun::of_many()));
  if (project.fpaa && project.choice == Project::Choice::tracking) add_board_controllers(project, out);
  return out;
}

}  // namespace bodesmith::project
