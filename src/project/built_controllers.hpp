#pragma once

#include <memory>
#include <vector>

#include "project/design.hpp"
#include "project/project.hpp"
#include "tracking/built_controller.hpp"

namespace bodesmith::project {

/// The analog controller of a project with [hardware.circuit]; null without. By [hardware.controller] form, else, where
/// tracking decides, the generator fed by its own drive, or where that cannot be made two passes, then one; otherwise
/// the disturbance paper's one pass. What cannot be made, and why, is added to `passed_over`.
std::shared_ptr<const controller::AnalogController> make_analog_controller(
    const Project& project, std::vector<std::string>& passed_over);

/// Every controller of the design that can be run here: the analog one where ngspice is installed; where tracking
/// decides, those of the board, fed by their own drive. The design must
/// outlive them.
std::vector<std::unique_ptr<tracking::BuiltController>> built_controllers(const Project& project,
                                                                          const Design& design);

}  // namespace bodesmith::project
