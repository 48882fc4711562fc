#pragma once

#include "schematic/analysis/rest_point.hpp"
#include "synthesis/controller/controller.hpp"

namespace bodesmith::controller {

/// The slope meter as it is built: w' = -volts dr/dt behind two lags, then its absolute value, turned negative and smoothed.
struct SlopeMeterGains {
  double volts = 0.0;  ///< per V/s of r (with amplitude gains of r over the stroke); 0: no meter
  double offset = 0.0;
  double lag1_s = 0.0, lag2_s = 0.0, smoothing_s = 0.0;
  double half_gain = 1.0, half_offset = 0.0;
  double direct = 1.0, half = 2.0, full_offset = 0.0;

  static SlopeMeterGains of(const AnalogController& controller, const schematic::Deviations& off);
  /// Its output (node sn) for dr/dt in V/s, in steady state.
  double output_v(double slope_v_per_s) const;
};

/// How a controller's voltages at rest follow from one another: from the slope meter's voltage and the stroke to the control
/// voltages of the gains; from those, r and the generator's argument to v. Keeps the controller, which outlives it.
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
  /// `like`: another copy of the same wiring (see RestPoint).
  AtRest(const RestWiring& wiring, const schematic::Deviations& off, const AtRest* like = nullptr);

  /// The slope meter's voltage (0 or below); the control voltages follow.
  void set_slope(double volts);
  /// The stroke, 1 to begin with: the amplitude gains follow.
  void set_stroke(double alpha);
  /// Of the rate gain of branch 0 (rising) or 1; 0 where it does not change.
  double control_v(int branch) const { return rate_control_[branch].volts; }
  /// In place of what the slope makes.
  void set_control(int branch, double volts) { rate_control_[branch].volts = volts; }
  /// The argument is in strokes. v that the subtraction makes for r and the generator's argument (ignored unless it is given).
  double made(double r, double argument, bool rising);
  /// Of the last made(), by node.
  double volts(const std::string& node) const { return generator_.volts(node); }
  /// dv/dr of the subtraction, the argument held.
  double reference_gain() const { return reference_gain_; }
  /// 1 + Rf (sum of conductances at the inverting input) of an op-amp of the generator.
  double noise_gain(int opamp);

 private:
  const RestWiring* wiring_;
  schematic::Deviations off_;
  schematic::RestPoint rate_, generator_;
  /// Its node where it is made and where it is read.
  struct Control {
    int made = -1, read = -1;
    double volts = 0.0;
  };
  void follow(Control* controls);

  int slope_ = -1, stroke_ = -1, reference_ = -1, argument_ = -1, drive_ = -1;
  Control rate_control_[2], amplitude_control_[2];
  double alpha_ = 1.0;
  /// Of the argument: V at the generator for 1 V before the division by the stroke, and for none.
  double argument_gain_ = 1.0, argument_offset_ = 0.0;
  double reference_gain_ = 1.0;
};

/// K g d(x) by the parts as realised, at the rate of a triangle of reference_stroke.
class BuiltGenerator {
 public:
  explicit BuiltGenerator(const AnalogController& controller)
      : BuiltGenerator(controller, schematic::Deviations::none(controller)) {}
  BuiltGenerator(const AnalogController& controller, const schematic::Deviations& off);
  void set_rate(Hertz operating);
  void set_stroke(double alpha) { rest_.set_stroke(alpha); }
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

/// Greatest |K g d - what the rounded parts make of it|, percent of range, over the drives that occur and the gain
/// curves' corners and middles (steady triangles).
double generator_error_percent(const AnalogController& controller);

}  // namespace bodesmith::controller
