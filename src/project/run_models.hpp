#pragma once

#include <optional>

#include "chain/chain.hpp"
#include "project/run.hpp"

namespace bodesmith::project {

/// The stage as the project has it, per unit of the full-stroke drive: amplifier, hysteresis, damping compensator,
/// resonance, stroke (m).
chain::Chain stage_model(const Project& project);
/// The whole chain as built, from the reference to the displacement: the analog controller as its parts make its polynomials
/// and rate gains (a `loop`), then the stage. Nothing where no controller was built. Rate gains are those of the lowest
/// tracked frequency (`operating_hz`).
std::optional<chain::Chain> built_model(const ProjectRun& run);

}  // namespace bodesmith::project
