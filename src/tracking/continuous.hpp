#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tracking/periodic.hpp"
#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// Continuous designs: `samples` of y/stroke over one repeat of the reference in steady state, by CVODE, restarted
/// at the reference's turning points and where the drive turns. It begins with the states of the harmonic
/// computation and is repeated, its start corrected, until one repeat ends where it began: a periodic orbit of the
/// ODE, whatever it began with. Nothing when the design has a part with no time domain (see DrivenStage).
std::optional<std::vector<double>> track_continuous(const Plant& plant, const Design& design,
                                                    const Options& options, const PeriodicTracking& periodic,
                                                    const PeriodicState& begin, std::size_t samples);

}  // namespace bodesmith::tracking
