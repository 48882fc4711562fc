#pragma once

#include <optional>
#include <vector>

#include "fpaa/plan/clock_features.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/switched_board.hpp"

namespace bodesmith::fpaa {

/// Nodes are looked at up to this share of the fastest clock.
inline constexpr double kOfFastest = 0.45;

/// Inputs at which the first node of the board, op-amps inside a CAM among them, reaches full scale.
struct Headroom {
  double sine_v = 0.0;  ///< amplitude, any frequency up to kOfFastest
  double step_v = 0.0;  ///< height
};

/// Step responses of nodes,
///   y(t) = 2/pi int_0^oo Re H(jw) sin(w t)/w dw,
/// H the component at the sine's own frequency, straight between the points of a logarithmic grid: by sine integrals (within a few
/// percent).
class StepPeaks {
 public:
  explicit StepPeaks(const std::vector<Hertz>& grid);
  /// The largest |y(t)| of a node whose H on the grid is given.
  double largest(const std::vector<Complex>& node) const;

 private:
  std::size_t count_;
  std::vector<double> table_;  ///< Si(w t), all frequencies of a time together
};

/// Every op-amp at every frequency of a grid: [frequency], SwitchedBoard::nodes().
using BoardNodes = std::vector<std::vector<PeriodicNetworks::NodeSize>>;
std::vector<BoardNodes> nodes_over(const SwitchedBoard& board, const std::vector<Hertz>& grid);

/// The peak of every op-amp, as the switches make its voltage: over frequency (next to clocks, too), the largest value at any instant; and
/// of its step response.
Headroom headroom_of(const SwitchedBoard& switched, const Plan& plan, Band band);

/// Lines at the output pin that are not the signal, over sines of the band: k fc +- f of every clock, against the
/// signal at the output. Sines near a clock within the band are among
/// them: what a slow path samples there comes out as a slow beat, whose line may be larger than the signal.
struct ImageLines {
  std::optional<ImageLine> largest;  ///< below 100 kHz; nothing when none lies there
  std::optional<ImageLine> in_band;  ///< within the band
  /// Of sines of the band (image_sines): the rms of their lines within the band (1: the input's).
  struct Sine {
    BandSine signal;
    double rms = 0.0;
  };
  std::vector<Sine> sines = {};
};
ImageLines images_of(const SwitchedBoard& board, const Plan& plan, Band band);

}  // namespace bodesmith::fpaa
