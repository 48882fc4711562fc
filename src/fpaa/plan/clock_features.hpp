#pragma once

#include <span>
#include <vector>

#include "base/units.hpp"
#include "fpaa/plan/plan.hpp"
#include "lti/frequency_grid.hpp"

namespace bodesmith::fpaa {

/// Poles of this share of their clock and more have no narrow feature.
inline constexpr double kNarrow = 1.0 / 6.0;

/// A pole of a CAM and the clock that the CAM samples with.
struct ClockedPole {
  Hertz clock;
  Complex pole_hz;  ///< s/(2 pi): real part its width, imaginary part its frequency
};
std::vector<ClockedPole> clocked_poles(const Plan& plan);

/// Where a coarse grid misses what a sampled path does. A sampled response repeats about every multiple of its
/// clock, its hold is zero just there: between the two a pole of width p leaves a dip of width p in an otherwise
/// level response, at k fc and (complex poles) at k fc +- their frequency. Returned: those places, `offsets`
/// widths around each, for the first `multiples` of each clock, within the band. The multiples themselves are left out (offset 0 is not allowed): a line folds
/// back onto the sine there, and the amplitude depends on the phase.
std::vector<Hertz> near_clocks(const std::vector<ClockedPole>& poles, Band band,
                               std::span<const double> offsets, int multiples);

/// Lines that clocks put around a sine, each once: k fc + f (below 0: the conjugate line above) for the first multiples and for those
/// whose lines are nearest to 0, without the sine's own; of these the ones whose |frequency| lies in the band.
std::vector<double> clock_lines_hz(std::span<const double> clocks_hz, double sine_hz, Band band);

}  // namespace bodesmith::fpaa
