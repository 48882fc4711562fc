#pragma once

#include <functional>
#include <optional>
#include <string>

#include "schematic/analysis/equations.hpp"

namespace bodesmith::multiplier_layout {

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

}  // namespace bodesmith::multiplier_layout
