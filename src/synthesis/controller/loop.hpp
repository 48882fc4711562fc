#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "synthesis/controller/library.hpp"

namespace bodesmith::generator {

/// Where a loop is looked at: the branch, the drive, the frequency whose rate gain holds and the stroke.
struct LoopPoint {
  Disturbance::Branch branch = Disturbance::Branch::ascending;
  double v = 0.0;
  Hertz operating;
  double rate_gain = 1.0;
  double stroke = 1.0;  ///< by which the argument is divided, where there are amplitude gains
};

/// The generator and the subtraction at one point. The generator's loop runs from v through powers, branch, rate
/// gain and switch back to v; an op-amp's return ratio -A (v+ - v-) has every feedback in it, its own and the
/// generator's. 1 + T is what must not vanish.
struct LoopAt {
  LoopPoint point;
  double greatest_gain = 0.0;   ///< of the generator's loop, |T| over all frequencies
  double gain_margin_db = 0.0;  ///< 1/|T| where T crosses the negative real axis; 0: it never does
  double nearest = 1.0;         ///< least |1 + T|: 1 over the greatest amplification of a disturbance
  Hertz bandwidth;              ///< |T| at .707 of its value at rest
  struct OpAmpMargin {
    std::string opamp, role;
    double margin_deg = 180.0;  ///< where |T| = 1; below 0: unstable
    Hertz crossing;
  };
  std::vector<OpAmpMargin> opamps;  ///< of the loop
};

/// What a change of branch does to v, by ngspice: from one branch to the other at rest where they differ most.
struct SwitchStep {
  double v = 0.0;
  double step_percent = 0.0;       ///< of the stroke, from one branch's v to the other's
  double overshoot_percent = 0.0;  ///< beyond either, of the stroke
  double settled_s = 0.0;          ///< from the control until within .02 % of the stroke for good
};

struct LoopStability {
  std::vector<LoopAt> at;  ///< v = 0 … 1 strokes, both branches, the rate gains' ends and corners; the full
                           ///< stroke, the table's least, and where g(alpha)/alpha is greatest
  double greatest_gain = 0.0;  ///< of the generator's loop at any point
  double nearest = 1.0;        ///< least |1 + T| of it
  double margin_deg = 180.0;   ///< least of any op-amp at any point
  std::string opamp, role;     ///< whose it is
  LoopPoint point;
  Hertz crossing;
  /// By ngspice on the emitted netlist, at the worst point.
  struct Checked {
    double margin_deg = 0.0;
    Hertz crossing;
    double greatest_gain = 0.0;        ///< of the generator's loop at the point where that is worst
    double greatest_difference = 0.0;  ///< |T of ngspice - T of the program's network|, generator's loop
    std::optional<SwitchStep> step;
  };
  std::optional<Checked> ngspice;
};

/// Below this margin a warning, below that a refusal (unless allowed).
constexpr double kGoodMarginDeg = 45.0, kLeastMarginDeg = 30.0;

/// By the program's own network of the emitted parts: op-amps with their gain-bandwidth and output resistance,
/// multipliers with one pole, the switch's resistances and capacitances. Nothing for ideal op-amps.
LoopStability loop_stability(const DisturbanceCircuit& controller);
/// The same with ngspice alongside it. Needs ngspice.
LoopStability checked_loop_stability(const DisturbanceCircuit& controller);

/// Where a loop rests at a point.
struct LoopBias {
  double reference_v = 0.0;  ///< r that makes v
  double slope_v = 0.0;      ///< of the slope meter
  int position = 0;          ///< of the switch
  std::map<std::string, double> volts;
};
LoopBias bias_of(const DisturbanceCircuit& controller, const LoopPoint& point);

/// The generator's loop at a point, -v for 1 V at what reads it, cut there; 0 where the generator is not fed by its drive.
Complex generator_loop_gain(const DisturbanceCircuit& controller, const LoopPoint& point, RadPerSecond w);

/// What to change when the margin is below kGoodMarginDeg; empty when it is not.
std::string loop_warning(const LoopStability& loop);
/// What `stability` of controller.json holds.
Json to_json(const LoopStability& loop);
/// A line or two for a person.
std::string summary_text(const LoopStability& loop);
/// DesignError when the margin is below kLeastMarginDeg and `allowed` is false.
void require_stable(const LoopStability& loop, bool allowed);

}  // namespace bodesmith::generator
