#pragma once

#include "schematic/analysis/rest_point.hpp"
#include "synthesis/generator/circuit.hpp"

namespace bodesmith::generator {

/// The slope meter as it is built: w' = -volts dr/dt behind two lags, then its absolute value, turned negative and smoothed.
struct SlopeMeterGains {
  double volts = 0.0;  ///< per V/s of r (with amplitude gains of r over the stroke); 0: no meter
  double offset = 0.0;
  double lag1_s = 0.0, lag2_s = 0.0, smoothing_s = 0.0;
  double half_gain = 1.0, half_offset = 0.0;
  double half_rest =
      0.0;  ///< of the half wave while its diode is open: between its own op-amp's offset and the next one's
  double direct = 1.0, half = 2.0, full_offset = 0.0;

  static SlopeMeterGains of(const DisturbanceCircuit& controller, const Deviations& off);
  /// Its output (node sn) for dr/dt in V/s, in steady state.
  double output_v(double slope_v_per_s) const;
};

/// How a circuit's voltages at rest follow from one another. Open: from x and the stroke to d. Closed: from the slope meter's voltage
/// and the stroke to the control voltages of the gains; from those, r and the generator's argument to v. Keeps the circuit, which
/// outlives it.
struct RestWiring {
  /// `cut`: a controller's argument (kArgument) comes from outside. Otherwise only where it is fed by its own drive.
  explicit RestWiring(const DisturbanceCircuit& circuit, bool cut = false);

  const DisturbanceCircuit& circuit;
  bool argument_is_given;
  schematic::RestOrder rate, generator;
};

/// One built copy at rest.
class AtRest {
 public:
  /// `like`: another copy of the same wiring (see RestPoint).
  AtRest(const RestWiring& wiring, const Deviations& off, const AtRest* like = nullptr);

  /// The slope meter's voltage (0 or below); the control voltages follow.
  void set_slope(double volts);
  /// The stroke, 1 to begin with: the amplitude gains follow.
  void set_stroke(double alpha);
  /// Of a branch's rate gain; 0 where it does not change.
  double control_v(std::size_t branch) const { return branches_[branch].rate.volts; }
  /// In place of what the slope makes.
  void set_control(std::size_t branch, double volts) { branches_[branch].rate.volts = volts; }
  /// v that the subtraction makes for r and the generator's argument, in strokes (ignored unless it is given); open, d(argument).
  double made(double r, double argument, std::size_t branch);
  /// Of the last made(), by node.
  double volts(const std::string& node) const { return generator_.volts(node); }
  /// dv/dr of the subtraction, the argument held.
  double reference_gain() const { return reference_gain_; }
  /// 1 + Rf (sum of conductances at the inverting input) of an op-amp of the generator.
  double noise_gain(int opamp);

 private:
  const RestWiring* wiring_;
  Deviations off_;
  schematic::RestPoint rate_, generator_;
  /// Its node where it is made and where it is read.
  struct Control {
    int made = -1, read = -1;
    double volts = 0.0;
  };
  struct Controls {
    Control rate, amplitude;
  };
  void follow(Control Controls::*which);

  int slope_ = -1, stroke_ = -1, reference_ = -1, argument_ = -1, drive_ = -1;
  std::vector<Controls> branches_;
  double alpha_ = 1.0;
  /// Of the argument: V at the generator for 1 V before the division by the stroke, and for none.
  double argument_gain_ = 1.0, argument_offset_ = 0.0;
  double reference_gain_ = 1.0;
};

/// Open: d at each x, of the stroke alpha where there are amplitude gains.
std::vector<double> curve(AtRest at, std::size_t branch, const std::vector<double>& x, double alpha = 1.0);

/// K g d(x) by the parts as realised, at the rate of a triangle of reference_stroke.
class BuiltGenerator {
 public:
  explicit BuiltGenerator(const DisturbanceCircuit& controller)
      : BuiltGenerator(controller, Deviations::none(controller)) {}
  BuiltGenerator(const DisturbanceCircuit& controller, const Deviations& off);
  void set_rate(Hertz operating);
  void set_stroke(double alpha) { rest_.set_stroke(alpha); }
  /// What is subtracted from r when the generator's argument is x.
  double subtracted(Disturbance::Branch which, double x);
  /// dv/dr, the generator's argument held.
  double reference_gain() const { return rest_.reference_gain(); }
  /// The rate gain, relative to the branch's polynomial.
  double rate_gain(Disturbance::Branch which) const;

 private:
  const DisturbanceCircuit& controller_;
  SlopeMeterGains meter_;
  RestWiring wiring_;
  AtRest rest_;
};

/// Greatest |K g d - what the rounded parts make of it|, percent of range, over the drives that occur and the gain
/// curves' corners and middles (steady triangles).
double generator_error_percent(const DisturbanceCircuit& controller);

}  // namespace bodesmith::generator
