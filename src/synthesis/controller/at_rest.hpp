#pragma once

#include "schematic/analysis/rest_point.hpp"
#include "synthesis/controller/controller.hpp"

namespace bodesmith::controller {

/// The slope meter as it is built: w' = -volts dr/dt behind two lags, then its absolute value, turned negative and smoothed.
struct SlopeMeterGains {
  double volts = 0.0;  ///< per V/s; 0: no meter
  double offset = 0.0;
  double lag1_s = 0.0, lag2_s = 0.0, smoothing_s = 0.0;
  double half_gain = 1.0, half_offset = 0.0;
  double direct = 1.0, half = 2.0, full_offset = 0.0;

  static SlopeMeterGains of(const AnalogController& controller, const schematic::Deviations& off);
  /// Its output (node sn) for dr/dt in V/s, in steady state.
  double output_v(double slope_v_per_s) const;
};

/// How a controller's voltages at rest follow from one another: from the slope meter's voltage to the control voltages of the
/// rate gains; from those, r and the generator's argument to v. Keeps the controller, which outlives it.
struct RestWiring {
  /// `cut`: the generator's argument (kArgument) comes from outside. Otherwise only where it is fed by its own drive.
  explicit RestWiring(const AnalogController& controller, bool cut = false);

  const AnalogController& controller;
  bool argument_is_given;
  schematic::RestOrder rate, generator;
};

/// One built copy at rest.
class AtRest {
 public:
  AtRest(const RestWiring& wiring, const schematic::Deviations& off);

  /// The slope meter's voltage (0 or below); the control voltages follow.
  void set_slope(double volts);
  /// Of branch 0 (rising) or 1; 0 where its gain does not change.
  double control_v(int branch) const { return control_v_[branch]; }
  /// In place of what the slope makes.
  void set_control(int branch, double volts) { control_v_[branch] = volts; }
  /// v that the subtraction makes for r and the generator's argument (ignored unless it is given).
  double made(double r, double argument, bool rising);
  /// Of the last made(), by node.
  double volts(const std::string& node) const { return generator_.volts(node); }
  /// dv/dr of the subtraction, the argument held.
  double reference_gain() const { return reference_gain_; }
  /// 1 + Rf (sum of conductances at the inverting input) of an op-amp of the generator.
  double noise_gain(int opamp);

 private:
  const RestWiring* wiring_;
  schematic::RestPoint rate_, generator_;
  int slope_ = -1, reference_ = -1, argument_ = -1, drive_ = -1;
  int makes_control_[2] = {-1, -1}, reads_control_[2] = {-1, -1};
  double control_v_[2] = {0.0, 0.0};
  double reference_gain_ = 1.0;
};

/// K d(x) by the parts as realised, at the rate of a triangle of reference_stroke.
class BuiltGenerator {
 public:
  explicit BuiltGenerator(const AnalogController& controller)
      : BuiltGenerator(controller, schematic::Deviations::none(controller)) {}
  BuiltGenerator(const AnalogController& controller, const schematic::Deviations& off);
  void set_rate(Hertz operating);
  /// What is subtracted from r when the generator's argument is x.
  double subtracted(Disturbance::Branch which, double x);
  /// dv/dr, the generator's argument held.
  double reference_gain() const { return rest_.reference_gain(); }
  /// The rate gain, relative to the branch's polynomial.
  double rate_gain(Disturbance::Branch which) const;

 private:
  const AnalogController& controller_;
  SlopeMeterGains meter_;
  RestWiring wiring_;
  AtRest rest_;
};

/// Greatest |K d - what the rounded parts make of it|, percent of range, over the drives that occur and the gain
/// curve's corners and middles (steady full-stroke triangles).
double generator_error_percent(const AnalogController& controller);

}  // namespace bodesmith::controller
