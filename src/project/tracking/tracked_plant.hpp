#pragma once

#include <vector>

#include "project/project.hpp"
#include "tracking/types.hpp"

namespace bodesmith::project {

/// The project's stage: amplifier in the drive path, damping compensator and resonance behind the disturbance.
tracking::Plant tracking_plant(const Project& project);

/// The same for a drive, at the largest tracked amplitude.
tracking::PolynomialStage own_stage(const Project& project);

/// What is tracked: all frequencies, the first waveform at the largest amplitude.
tracking::Options tracking_options(const Project& project);

/// The compensator stands in the path of the branch that changes with frequency; the other one keeps its
/// polynomial.
tracking::Design compensated_design(const Project& project, std::string name,
                                    tracking::Compensator compensator,
                                    tracking::GeneratorForm form = tracking::GeneratorForm::one_pass());

/// Rms error at each tracked frequency, percent of range, the best pure delay removed; harmonic by harmonic. Infinite
/// where the generator does not settle.
std::vector<double> tracked_percents(const Project& project, const tracking::Design& design);

}  // namespace bodesmith::project
