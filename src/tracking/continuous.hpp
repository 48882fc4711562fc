#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tracking/periodic.hpp"
#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// One repeat of a design in time. What a mean over it takes stands apart from the even samples: where a drive jumps the error is far
/// from 0 for a moment that lies between two of them, or is all of one.
struct ContinuousRun {
  struct Node {
    double time_s = 0.0;
    double y = 0.0;
    double share = 0.0;  ///< of the repeat, by Gauss's rule of two points within the solver's steps
  };
  std::vector<double> samples;  ///< y/stroke, even
  std::vector<Node> nodes;

  /// Of y - x(t - lag).
  double rms(const Reference& reference, double repeat_s, double lag_s) const;
};

/// Continuous designs: `samples` of y/stroke over one repeat of the reference in steady state, by CVODE, restarted
/// at the reference's turning points and where the drive turns. It begins with the states of the harmonic
/// computation and is repeated, its start corrected, until one repeat ends where it began: a periodic orbit of the
/// ODE, whatever it began with. Nothing when the design has a part with no time domain (see DrivenStage).
std::optional<ContinuousRun> track_continuous(const Plant& plant, const Design& design,
                                              const Options& options, const PeriodicTracking& periodic,
                                              const PeriodicState& begin, std::size_t samples);

}  // namespace bodesmith::tracking
