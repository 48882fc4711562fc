#pragma once

#include <utility>
#include <vector>

#include "fpaa/device/mismatch.hpp"
#include "fpaa/search/fit.hpp"
#include "fpaa/search/sine_response.hpp"

namespace bodesmith::fpaa {

/// What a design comes to, all as shares (1 = 100 %), on the grid of its table.
struct DesignScore {
  double designed = 0.0;  ///< largest |got - wanted|/reference within the band
  double p95 = 0.0;       ///< the same for 95 % of boards (Spread)
  double noise = 0.0;     ///< kT/C noise within the band against the output's largest sine
  double input = 1.0;  ///< sine at the pin that no node clips at, in full scales (of boards drawn: or step)
  double bound = 1.0;  ///< the same if only the input and what is asked for within the band could clip
  double image = 0.0;  ///< lines of the clocks within the band around a sine (images.hpp)
  /// What candidates are ranked by: what the pin shows besides what was asked for, of 95 % of boards. Images are other frequencies and
  /// add by squares. Below the input worth keeping, what stands outside the board (offsets, drivers) is larger against the
  /// signal: taken as kOutside there, it grows as the input falls.
  double total() const;
  /// An input of 1 V, or two thirds of the bound where that is less, in full scales.
  double wanted_input() const;
  /// By how much of itself each of what is wanted is missed, added up; 0: there is all of it.
  double missing() const;
  /// What designs are compared by, the least is the best: total() and the designed error once more (which no trim takes away), a share
  /// more for each op-amp and chip; a stage that AnadigmDesigner2 cannot make has to earn a tenth of a point.
  double rank(int opamps, bool vendor) const;
  /// What has all that is wanted of a plan comes first, what is of no use for its images last; of the others what misses more counts as
  /// so much worse.
  std::pair<int, double> place(double missing, int opamps, bool vendor) const;
};

/// The share of the bound that costs nothing.
inline constexpr double kInputWorthKeeping = 2.0 / 3.0;
inline constexpr double kOutside = 0.005;
/// What is asked of a plan: an error that nobody sees next to the mismatch of parts, and a signal well above a board's offsets.
inline constexpr double kWantedDesigned = 0.005;
inline constexpr double kWantedP95 = 0.015;
inline constexpr double kWantedInputV = 1.0;

/// What 95 % of boards keep: designed error and spread frequency by frequency, smooth, for a fit; or, as plans state it (plan_total), the
/// worst over frequency of each of 300 drawn boards.
enum class Spread { by_frequency, by_drawn_boards };

DesignScore score_of(const Design& design, const StageFactorTable& table, const BoardAssumptions& assumptions,
                     Spread spread);

/// What 95 % of boards keep at each point of the grid: the weighted errors with the mismatch of these capacitors.
std::vector<double> errors_of_95_percent(const std::vector<Complex>& errors, const CapacitorEffects& effects,
                                         const Design& design, const MismatchModel& mismatch);

/// Largest magnitude over the grid and up to nearly half the fastest clock of each stage's output, and of the op-amp inside it (0 for a
/// first-order one).
struct NodePeak {
  double output = 0.0;
  double inner = 0.0;
};
std::vector<NodePeak> node_peaks(const DesignResponse& response);

/// The dynamic-range optimum under the two ends that are given: every node's peak on the geometric way from the input's (1) to the
/// output's, an op-amp inside a stage as its output (all capacitors that leave a node times its factor, those that enter divided
/// by it; Schreier and Temes, Understanding Delta-Sigma Data Converters, 4.4, scaleABCD).
void scale_nodes(Design& design, const StageFactorTable& table);

/// What the switches put into the band around a sine, in closed form: all lines k fc +- f of its clocks there together, against the
/// response asked for at the sine; rms over sines spread evenly over the band's decades. 0 where every clock is above twice the band.
///
/// A stage of period T makes of a line m of its input, x the input and Tp the end of a phase,
///   int y exp(-jmt) dt = (y(Tp) + gp x(Tp)) int exp(-jmt) dt - gp int x exp(-jmt) dt      over each phase,
/// and a reader at a slower clock adds the faster one's periods up.
double image_share(const Design& design, const DesignTarget& target);

}  // namespace bodesmith::fpaa
