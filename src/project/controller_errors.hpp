#pragma once

#include <memory>
#include <optional>

#include "controller/controller.hpp"
#include "part_errors/report.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

/// What its parts do to the project's analog controller, tracking its triangle over the stage with amplifier, damping
/// compensator and resonance: Monte Carlo, trims tried blind, stability. Nothing without a controller. DesignError
/// when its loop lacks the least phase margin and the project does not allow that.
std::optional<part_errors::Report> examine_controller(
    const Project& project, const std::shared_ptr<const controller::AnalogController>& controller);

}  // namespace bodesmith::project
