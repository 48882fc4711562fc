#pragma once

#include <memory>
#include <optional>

#include "base/units.hpp"
#include "chain/chain.hpp"
#include "project/run.hpp"
#include "tracking/built_controller.hpp"

namespace bodesmith::project {

Hertz lowest_tracked(const Project& project);

/// The stage as the project has it, per unit of the full-stroke drive: amplifier (its corner may be refitted), hysteresis with
/// the rate gains of a period of `operating`, damping compensator, resonance, stroke (m).
chain::Chain stage_model(const Project& project, Hertz operating);

/// The whole chain as built, from the reference to the displacement: the analog controller as its parts make its polynomials
/// and rate gains at the lowest tracked frequency (a `loop`, with what each part does to it), then the stage. Nothing where no controller was built.
std::optional<chain::Chain> built_model(const Run& run);

/// The controller as its parts make it at rest, in closed form and without any dynamics ("controller_at_rest").
std::unique_ptr<tracking::BuiltController> controller_at_rest(
    const Project& project, std::shared_ptr<const generator::DisturbanceCircuit> controller);

}  // namespace bodesmith::project
