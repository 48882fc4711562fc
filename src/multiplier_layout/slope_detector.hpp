#pragma once

#include <complex>
#include <functional>
#include <optional>

#include "multiplier_layout/timing.hpp"

namespace bodesmith::multiplier_layout {

/// The slope detector of a layout as differential equations: Rs and Cd into an op-amp with Rd, Cf and two
/// antiparallel diodes around it, then an op-amp as comparator with hysteresis.
class SlopeDetector {
 public:
  explicit SlopeDetector(const Layout& layout, const DiodeModel& diode = {});

  /// Half the hysteresis at the differentiator's output, V.
  double threshold_v() const;
  /// Current of Rd and both diodes at v.
  double feedback_a(double v) const;
  /// Slope of x that brings the differentiator to the threshold, V/s.
  double least_slope_v_per_s() const { return feedback_a(threshold_v()) / cd_; }
  /// rms noise of the differentiator's output near rest, V: the op-amp's voltage noise times the noise gain,
  /// its current noise and Rd's.
  double noise_v() const;
  /// |differentiator's output / x| near rest.
  double gain(Hertz f) const;

  /// Time from `reversal_s` until the comparator's output passes 0 upwards, for x(t) that falls before and
  /// rises after; integrates from `start_s` to `stop_s`.
  std::optional<double> delay_s(const std::function<double(double)>& x, double start_s, double reversal_s,
                                double stop_s) const;

 private:
  /// Small signals near rest: impedances around the differentiator's op-amp, and what its finite gain leaves.
  struct Loop {
    std::complex<double> feedback, input, closed;
  };
  Loop loop(RadPerSecond w) const;
  double feedback_f(double v) const;

  circuit::OpAmpModel opamp_;
  DiodeModel diode_;
  double vt_ = 0.0;
  double rs_ = 0.0, cd_ = 0.0, rd_ = 0.0, cf_ = 0.0, hysteresis_ = 0.0;
};

}  // namespace bodesmith::multiplier_layout
