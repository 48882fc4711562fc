#pragma once

#include <string>
#include <vector>

#include "project/design.hpp"
#include "project/project.hpp"
#include "project/tracking_study.hpp"
#include "tracking/types.hpp"

namespace bodesmith::project {

/// A stage of the project's design as the tracking simulation takes it.
struct TrackedCandidate {
  TrackedStage stage;
  tracking::Design design;
};

/// Without compensation, the constant polynomial, then every stage from the ideal cascade to the hardware; and, where
/// something else is built, the best waveform fit and a gain scheduled by the measured frequency.
std::vector<TrackedCandidate> tracked_candidates(const Project& project, const Design& design);

/// The project's stage: amplifier in the drive path, damping compensator and resonance behind the disturbance.
tracking::Plant tracking_plant(const Project& project);

/// The plan's CAMs as one sampled chain.
tracking::ClockedCompensator clocked_compensator(const fpaa::Plan& plan, bool hold_and_delays);

}  // namespace bodesmith::project
