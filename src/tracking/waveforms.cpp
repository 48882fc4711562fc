#include "tracking/waveforms.hpp"

#include <cmath>
#include <numbers>

namespace bodesmith::tracking {

using Branch = Disturbance::Branch;

Waveforms::Waveforms(const Disturbance& disturbance, const Options& options, bool gated)
    : disturbance_(disturbance),
      triangle_(options.reference == Options::Reference::triangle),
      gated_(gated),
      alpha_(options.alpha),
      gain_{disturbance.amplitude_gain(Branch::ascending, options.alpha),
            disturbance.amplitude_gain(Branch::descending, options.alpha)} {}

double Waveforms::x_at(double theta, bool rising) const {
  if (triangle_) return alpha_ * (rising ? 2.0 * theta : 2.0 - 2.0 * theta);
  const double s = std::sin(std::numbers::pi * theta);  // (1 - cos 2 pi theta)/2
  return alpha_ * s * s;
}

double Waveforms::branch(Branch which, double x) const {
  return gain_[which == Branch::ascending ? 0 : 1] * disturbance_.value(which, x / alpha_);
}

double Waveforms::branch_slope(Branch which, double x) const {
  const auto& a = disturbance_.coefficients(which);
  const double z = x / alpha_;
  return gain_[which == Branch::ascending ? 0 : 1] * (a[0] + z * (2.0 * a[1] + z * 3.0 * a[2])) / alpha_;
}

Waveforms::Values Waveforms::at(double theta, bool rising) const {
  Values out;
  out.x = x_at(theta, rising);
  if (rising || !gated_) out.ascending = branch(Branch::ascending, out.x);
  if (!rising || !gated_) out.descending = branch(Branch::descending, out.x);
  return out;
}

Waveforms::Values Waveforms::slopes(double theta, bool rising) const {
  const double x = x_at(theta, rising);
  Values out;
  out.x = triangle_ ? (rising ? 2.0 : -2.0) * alpha_
                    : alpha_ * std::numbers::pi * std::sin(2.0 * std::numbers::pi * theta);
  if (rising || !gated_) out.ascending = branch_slope(Branch::ascending, x) * out.x;
  if (!rising || !gated_) out.descending = branch_slope(Branch::descending, x) * out.x;
  return out;
}

Waveforms::Values Waveforms::sampled(double theta) const {
  if (!gated_ || (theta != 0.0 && theta != 0.5)) return at(theta, theta < 0.5);
  const Values up = at(theta == 0.0 ? 0.0 : 0.5, true);
  const Values down = at(theta == 0.0 ? 1.0 : 0.5, false);
  return {up.x, 0.5 * up.ascending, 0.5 * down.descending};
}

}  // namespace bodesmith::tracking
