#pragma once

#include <memory>
#include <vector>

#include "controller/controller.hpp"
#include "project/project.hpp"
#include "tracking/built_controller.hpp"

namespace bodesmith::project {

/// Every controller of the project that can be run here: the analog one where there is one and ngspice is installed; where
/// tracking decides, those of the board, fed by their own drive.
std::vector<std::unique_ptr<tracking::BuiltController>> built_controllers(
    const Project& project, const std::shared_ptr<const controller::AnalogController>& analog);

}  // namespace bodesmith::project
