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

/// A sine of a band and its share in a mean over the band's logarithm.
struct BandSine {
  Hertz frequency;
  double share = 0.0;
};
/// Sines for the mean over a band of what clocks put beside them (clock_lines_hz), by trapezoids: spread over its decades, and around
/// every multiple of a clock at distances that grow by half, as the line that falls there from a sine next to a multiple is as narrow
/// as the path that samples it is slow (evenly spread sines miss it, or count one for many), and where lines come into the band. At
/// most `most` of them where that is no less than a spread's: distances grow faster, or are left out, where there would be more.
std::vector<BandSine> image_sines(std::span<const double> clocks_hz, Band band, double most);

/// Lines that clocks put around a sine, each once: k fc + f (below 0: the conjugate line above) for the first multiples and for those
/// whose lines are nearest to 0, without the sine's own; of these the ones whose |frequency| lies in the band.
std::vector<double> clock_lines_hz(std::span<const double> clocks_hz, double sine_hz, Band band);

}  // namespace bodesmith::fpaa
