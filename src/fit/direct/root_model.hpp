#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "base/units.hpp"

namespace bodesmith {

/// Stable, minimum-phase H(s) as a point theta for optimisers: ln(gain), then real roots by ln(corner), then
/// pairs of roots by (ln w0, ln zeta), s^2 + 2 zeta w0 s + w0^2; a pair with zeta > 1 is two real roots, so
/// pairs reach every configuration without a seam. Zeros first, then poles. H = gain * prod (zeros normalised
/// to 1 at the reference frequency) / prod (poles likewise), so that gain stays near the data.
struct RootModel {
  int real_zeros = 0;
  int zero_pairs = 0;
  int real_poles = 0;
  int pole_pairs = 0;
  RadPerSecond reference{1.0};

  int zeros() const { return real_zeros + 2 * zero_pairs; }
  int poles() const { return real_poles + 2 * pole_pairs; }
  Eigen::Index size() const { return 1 + zeros() + poles(); }
  /// Where each kind begins in theta.
  Eigen::Index first_real_zero() const { return 1; }
  Eigen::Index first_zero_pair() const { return first_real_zero() + real_zeros; }
  Eigen::Index first_real_pole() const { return first_zero_pair() + 2 * zero_pairs; }
  Eigen::Index first_pole_pair() const { return first_real_pole() + real_poles; }

  /// ln H(jw), the imaginary part unwrapped, and (unless null) its derivatives by theta.
  Complex log_response(const Eigen::VectorXd& theta, RadPerSecond w,
                       Eigen::RowVectorXcd* slope = nullptr) const;

  struct Roots {
    double gain = 1.0;  ///< H = gain * prod(s - z)/prod(s - p)
    std::vector<Complex> zeros;
    std::vector<Complex> poles;
  };
  Roots roots(const Eigen::VectorXd& theta) const;
};

/// RootModel at one theta, for many frequencies: everything that does not depend on the frequency is done
/// once.
class RootResponse {
 public:
  RootResponse(const RootModel& model, const Eigen::VectorXd& theta);
  /// As RootModel::log_response. Without `phase` the imaginary part is left 0 (and its derivatives too when
  /// `slope` is taken for magnitudes only): no arctangents.
  Complex at(RadPerSecond w, Eigen::RowVectorXcd* slope, bool phase) const;
  /// H(jw) itself as a product, and (unless null; as many columns as there are numbers) the derivatives of ln H, at many
  /// frequencies: no logarithm, no arctangent.
  void values(const std::vector<RadPerSecond>& w, Eigen::VectorXcd& h, Eigen::MatrixXcd* slope) const;
  /// ln|H| at many frequencies and (unless null) its derivatives, a column a parameter: as at(), root by root instead of
  /// frequency by frequency, which is several times as fast.
  void levels(const std::vector<RadPerSecond>& w, Eigen::VectorXd& log_gain, Eigen::MatrixXd* slope) const;

 private:
  struct Root {
    bool pair;
    double sign;
    double corner;            ///< of a real root, or w0
    double damping;           ///< 2 zeta w0 of a pair
    double reference_square;  ///< |value at the reference|^2
    double reference_scale;   ///< 1/|value at the reference|
    Complex reference_slope[2];

    Complex value(RadPerSecond w) const;
    /// d ln value by this root's parameters, from column `place` on; the place behind them.
    Eigen::Index add_slope(RadPerSecond w, Complex value, Eigen::Index place,
                           Eigen::RowVectorXcd& slope) const;
  };
  double log_gain_;
  std::vector<Root> roots_;
};

/// What a root may be: corner frequencies within [low, high], damping of pairs at least `min_damping`.
struct RootLimits {
  RadPerSecond low{std::numeric_limits<double>::min()};
  RadPerSecond high{std::numeric_limits<double>::max()};
  double min_damping = 1e-3;
};

/// A x <= b.
struct LinearLimits {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
};

/// What keeps theta + radius x within the limits (linearised for the larger root of an overdamped pair) and every
/// |x_i| <= 1: a step in units of a trust region's radius.
LinearLimits trust_region_limits(const RootModel& model, const RootLimits& limits,
                                 const Eigen::VectorXd& theta, double radius);
/// Moves theta into the limits.
void clamp(const RootModel& model, const RootLimits& limits, Eigen::VectorXd& theta);

}  // namespace bodesmith
