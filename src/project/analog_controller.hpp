#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/controller.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

/// The analog controller of a project with [hardware.circuit]; null without.
struct AnalogControllerMade {
  std::shared_ptr<const controller::AnalogController> controller;
  std::vector<std::string> passed_over;  ///< forms that cannot be made, and why
};

/// By [hardware.controller] form, else, where tracking decides, the generator fed by its own drive, or where that cannot be
/// made two passes, then one; otherwise the disturbance paper's one pass.
AnalogControllerMade make_analog_controller(const Project& project);

}  // namespace bodesmith::project
