#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "project/project.hpp"
#include "synthesis/generator/circuit.hpp"
#include "tolerance/controller/report.hpp"

namespace bodesmith::project {

/// The analog controller of a project with [hardware.circuit]; null without.
struct AnalogControllerMade {
  std::shared_ptr<const generator::DisturbanceCircuit> controller;
  std::vector<std::string> passed_over;  ///< forms that cannot be made, and why
};

/// By [hardware.controller] form, else, where tracking decides, the generator fed by its own drive, or where that cannot be
/// made two passes, then one; otherwise the disturbance paper's one pass.
AnalogControllerMade make_analog_controller(const Project& project);

/// What its parts do to the project's analog controller, tracking its triangle over the stage with amplifier, damping
/// compensator and resonance: Monte Carlo, trims tried blind, stability. Nothing without a controller. DesignError
/// when its loop lacks the least phase margin and the project does not allow that.
std::optional<tolerance::ControllerReport> examine_controller(
    const Project& project, const std::shared_ptr<const generator::DisturbanceCircuit>& controller);

}  // namespace bodesmith::project
