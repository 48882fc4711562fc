#pragma once

#include "signal/disturbance.hpp"
#include "tracking/types.hpp"

namespace bodesmith::tracking {

/// The reference and the generator's waveforms at one operating frequency, as functions of the phase theta in
/// [0, 1) of a period; x rises over [0, 1/2] and falls over [1/2, 1].
class Waveforms {
 public:
  /// `gated`: a branch is 0 while the other one is on. The stage's own disturbance always is.
  Waveforms(const Disturbance& disturbance, const Options& options, bool gated = true);

  struct Values {
    double x = 0.0;
    double ascending = 0.0;
    double descending = 0.0;
  };
  /// `rising` decides the branch (both are right at a corner).
  Values at(double theta, bool rising) const;
  /// Derivatives by theta.
  Values slopes(double theta, bool rising) const;
  /// At a corner the mean of both sides.
  Values sampled(double theta) const;

  /// d of one branch for a stage input x in [0, alpha], and its derivative by x.
  double branch(Disturbance::Branch which, double x) const;
  double branch_slope(Disturbance::Branch which, double x) const;

 private:
  double x_at(double theta, bool rising) const;
  const Disturbance& disturbance_;
  bool triangle_;
  bool gated_;
  double alpha_;
  double gain_[2];
};

}  // namespace bodesmith::tracking
