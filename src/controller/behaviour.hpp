#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controller/as_built.hpp"
#include "schematic/deviations.hpp"

namespace bodesmith::controller {

/// The controller as algebra, microseconds a period: every sum with its resistors and its op-amp's offset, every
/// rectifier a corner, every multiplier W = (X + x)(Y + y)/(U (1 + scale)) (1 + bend) + Z + w. A branch is then
/// a cubic in its argument, times its rate gain; v = r - K d(v) is solved by Newton's method at each sample. Of
/// what takes time there is the smoothing behind the slope meter and the delay of the switch; op-amps and
/// multipliers are instantaneous.
class Behaviour {
 public:
  explicit Behaviour(const AnalogController& controller);

  /// Everything that may be off, and how late the switch is.
  Deviations off;
  double switch_delay_s = 0.0;

  /// The drive over one repeat of the reference, in steady state.
  Settled run(const tracking::Reference& reference, Hertz operating, std::size_t samples = 1024) const;

  /// Control voltage (node "ca", "cd") for a slope meter at `slope_v` (>= 0), V; 0 without rate gains.
  double control_v(Disturbance::Branch which, double slope_v) const;
  /// The rate gain that a steady full-stroke triangle gets, relative to the branch's polynomial.
  double rate_gain(Disturbance::Branch which, Hertz operating) const;
  /// What the first pass subtracts from r when its argument is x: K d(x) and its errors.
  double subtracted(Disturbance::Branch which, double x, double control_v) const;
  /// Slope meter (volts) for dr/dt in V/s, before the smoothing.
  double slope_v(double slope_v_per_s) const;

  struct Cubic {
    double c[4] = {0.0, 0.0, 0.0, 0.0};
    double value(double x) const { return c[0] + x * (c[1] + x * (c[2] + x * c[3])); }
    double slope(double x) const { return c[1] + x * (2.0 * c[2] + x * 3.0 * c[3]); }
  };
  /// v = reference r - load * (switch node) + offset; a pass as it is built.
  struct BuiltPass {
    double reference = 1.0, load = 0.0, offset = 0.0;
    Cubic sum[2];  ///< b_b(x), V
  };

  /// The controller's passes with what is off.
  BuiltPass build(const Pass& pass) const;
  /// Switch node of a pass whose sum of branch b gives sum_v.
  double gained(const Pass& pass, int b, double sum_v, double control_v) const;
  double noise_gain(const Sum& sum) const;

 private:
  Cubic branch_cubic(const Pass& pass, const BranchPath& path) const;
  double sum_value(const Sum& sum, const std::map<std::string, double>& node) const;
  double multiply(int multiplier, double x, double y, double z) const;
  /// Switch node for an argument x.
  double node(const BuiltPass& built, const Pass& pass, int b, double x, double control_v) const;
  double solve(const BuiltPass& built, const Pass& pass, int b, double r, double control_v,
               double guess) const;
  std::vector<double> slope_signal(const tracking::Reference& reference, Hertz operating,
                                   std::size_t samples) const;

  const AnalogController& controller_;
};

/// Greatest |K d - what the rounded parts make of it|, percent of range, over the drives that occur and the gain
/// curve's corners and middles (steady full-stroke triangles).
double generator_error_percent(const AnalogController& controller);

/// From the turn at the end of a repeat to the new contact: slope detector (integrated from its circuit) and
/// switch. InputError when the slope never reaches the detector's threshold.
double switch_delay_s(const AnalogController& controller, const tracking::Reference& reference,
                      Hertz operating);
/// Of a full-stroke triangle.
inline double switch_delay_s(const AnalogController& controller, Hertz operating) {
  return switch_delay_s(controller, tracking::Reference(), operating);
}

}  // namespace bodesmith::controller
