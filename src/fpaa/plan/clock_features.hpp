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

/// A sine of a band, and what it counts for in the mean over the band's logarithm of what one clock puts beside sines.
struct BandSine {
  Hertz frequency;
  double share = 0.0;
  std::size_t clock = 0;
};
/// Sines for that mean of each clock (clock_lines_hz), by the middles of panels: over the decades below half the clock, and around its
/// multiples at distances that grow evenly, as the line that falls there from a sine next to a multiple is as narrow as the path that
/// samples it is slow (sines spread evenly over the band miss it, or count one for many). At most `most` of them, if in
/// wider panels. Clocks beyond twice the band have none.
std::vector<BandSine> image_sines(std::span<const double> clocks_hz, Band band, double most);

/// Lines that a clock puts around a sine, each once (of several clocks that put it there it is the fastest one's): k fc + f (below 0:
/// the conjugate line above) for the first multiples and for those whose lines are nearest to 0, without the sine's own; of these the
/// ones whose |frequency| lies in the band.
std::vector<double> clock_lines_hz(std::span<const double> clocks_hz, std::size_t clock, double sine_hz,
                                   Band band);

}  // namespace bodesmith::fpaa
