#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "schematic/analysis/equations.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/circuit.hpp"

namespace bodesmith::generator {

/// The slope detector as it is built.
struct SlopeDetectorFigures {
  double threshold_v = 0.0;          ///< half the comparator's hysteresis, at the differentiator's output
  double least_slope_v_per_s = 0.0;  ///< of x, that reaches the threshold
  double noise_v = 0.0;              ///< rms at the differentiator's output, its op-amp's and Rd's
  double noise_margin = 0.0;         ///< full hysteresis over noise_v
  double hum_50_hz_v = 0.0;          ///< amplitude of 50 Hz on a resting x that reaches the threshold
  double ripple_v = 0.0;             ///< the same at the frequency where least is enough
  double ripple_hz = 0.0;

  /// From the reversal of x to the switch's control: x a triangle or a sinusoid of 0 to 1 V; none: the slope
  /// never reaches the threshold.
  struct Delay {
    Hertz frequency;
    std::optional<double> triangle_s, sine_s;
  };
  std::vector<Delay> delays;
};

/// What a reversal does to the output.
struct SwitchFigures {
  double opens_s = 0.0;        ///< the old contact, after the control
  double closes_s = 0.0;       ///< the new contact
  double hold_s = 0.0;         ///< time constant of the open node: its capacitance and Rin
  double charge_step_v = 0.0;  ///< at the open node
  /// Greatest departure from the held value at the output while both contacts are open, percent of range:
  /// from the droop of a node at full scale, from the injected charge, both.
  double droop_percent = 0.0, charge_percent = 0.0, glitch_percent = 0.0;
  double glitch_area_percent_s = 0.0;

  /// Triangle of 0 to 1 V: slope detector and switch together.
  struct Late {
    Hertz frequency;
    double delay_s = 0.0;
    double step_percent = 0.0;  ///< greatest |d_wrong - d_right| before the new branch comes
    double rms_percent = 0.0;   ///< of the whole period against the polynomials: parts, lags, late switching
    double rms_off_percent = 0.0;  ///< the same with multipliers_off()
    double peak_percent = 0.0;     ///< greatest |error| of the period, without the glitch
  };
  std::vector<Late> late;
};

struct Timing {
  SlopeDetectorFigures detector;
  SwitchFigures analog_switch;
};

/// `frequencies` of the reference. Empty figures for a layout with one branch.
Timing make_timing(const DisturbanceCircuit& layout, const std::vector<Hertz>& frequencies);

/// Glitch at the output for a branch node at `held_v` when the switch opens, V: greatest departure from the
/// output's value before. With tau = hold time, w = the output amplifier's closed-loop bandwidth,
///   y(t) = -(Rg/Rin) [ v0 w/(w - 1/tau) (exp(-t/tau) - exp(-w t)) - held (1 - exp(-w t)) ],
/// v0 = held + injected charge/capacitance, t up to the gap, |y| at most the op-amp's slew rate times t.
double switch_glitch_v(const DisturbanceCircuit& layout, double held_v, double charge_sign);

/// The slope detector of a disturbance generator or a controller: Rs and Cd into an op-amp with Rd, Cf and two antiparallel
/// diodes around it (node sc), then an op-amp as comparator with hysteresis (node so).
class SlopeDetector {
 public:
  /// `input`: the node whose slope is told.
  SlopeDetector(schematic::Netlist detector, std::string input);

  /// Half the hysteresis at the differentiator's output, V.
  double threshold_v() const;
  /// Current of Rd and both diodes at v.
  double feedback_a(double v) const;
  /// Slope of the input that brings the differentiator to the threshold, V/s.
  double least_slope_v_per_s() const { return feedback_a(threshold_v()) / value("Cd"); }
  /// rms noise of the differentiator's output near rest, 0.1 Hz to 30 MHz, V.
  double noise_v() const;
  /// |differentiator's output / input| near rest.
  std::vector<double> gains(const std::vector<Hertz>& grid) const;

  /// Time from `reversal_s` until the comparator's output passes 0 upwards, for an input x(t) that falls before and rises
  /// after; the circuit in time (CVODE) from `start_s` to `stop_s`.
  std::optional<double> delay_s(const std::function<double(double)>& x, double start_s, double reversal_s,
                                double stop_s) const;

 private:
  double value(const char* name) const { return netlist_.part_named(name)->realised; }
  const schematic::OpAmpModel& model() const { return netlist_.model_of(netlist_.opamps.front()); }
  double vt() const;
  double hysteresis() const { return value("Rh1") / (value("Rh1") + value("Rh2")); }

  schematic::Netlist netlist_;
  std::string input_;
};

}  // namespace bodesmith::generator
