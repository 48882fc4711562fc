#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "hysteresis/model_type.hpp"
#include "hysteresis/nested_loops.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::hysteresis {

/// The hysteretic disturbance of the disturbance paper (eq. 1-13): y = x + d(x), x in [0, 1] of the full
/// stroke, with
///   d(x) = a1 x + a2 x² + a3 x³    (eq. 1, 12; polynomial)   or
///   d(x) = A sin(π x)              (eq. 9; sine)
/// one set for the ascending, one for the descending branch, d(0) = d(1) = 0 (eq. 2, 3: a3 = −a1 − a2).
///
/// Amplitude gains (Fig. 3c, d): on a stroke of length α the disturbance is α_b(α) d(x/α), α_b interpolated
/// from the tables alpha, alpha_1 (ascending), alpha_2 (descending); without tables α_b(α) = α (the loop
/// keeps its shape). Rate gains (Table I): at operating_hz the branch is multiplied by its rate gain,
/// interpolated over log frequency.
///
/// Two rules for which branch holds (`minor`):
///  * slope_sign: the sign of the input's slope alone (contract, Fig. 2): y = x + α_b(α) d_b(x/α) with the
///    fixed `amplitude` α. A reversal inside the stroke jumps from one polynomial to the other.
///  * nested: turning points are remembered (NestedLoops). A branch between the turning point it left and the
///    one it heads for, x_lo … x_hi, carries the disturbance of a stroke of that length on the chord between them:
///      y = chord(x) + α_b(Δ) [d_b(s) − d_b(0) − s (d_b(1) − d_b(0))],  s = (x − x_lo)/Δ,  Δ = x_hi − x_lo,
///    so it is continuous, closes every loop (return-point memory) and is the paper's model on every triangle
///    from 0. Before there is a turning point to head for, the branch heads for the end of the stroke (0 or
///    1). This is our reading of how the paper follows "complex" references (Fig. 11, 12); it prints no rule.
/// Signs: with the coefficients as the paper prints them the ascending branch lies above the descending one,
/// i.e. the loop runs clockwise and ∮ u dy < 0, the reverse of a piezo stage's displacement over its drive;
/// they are the disturbance as the compensator adds it. Both signs are legal here. Rate-independent (the rate
/// gain is a constant of the block). Inverse: the root on the branch, exact to rounding where y rises with x. Under
/// slope_sign each sample takes the branch on which the output comes nearest to the reference, that of the
/// reference's own direction where both do: with a stage's signs every reference within the stroke is met;
/// with the paper's (the loop clockwise) a turn inside the stroke asks for outputs between the branches, which no
/// input gives.
struct BranchShape {
  std::array<double, 3> polynomial{};
  double sine = 0.0;
  bool is_sine = false;

  /// d(s), s in [0, 1]; outside the polynomial goes on, the sine too.
  double value(double s) const;
  double slope(double s) const;
};

struct PolynomialDisturbance {
  BranchShape ascending;
  BranchShape descending;
  bool nested = false;
  double amplitude = 1.0;
  Disturbance::AmplitudeGains strokes;
  double rate_gain_ascending = 1.0;
  double rate_gain_descending = 1.0;
  /// slope_sign only: the switch follows the slope this much later (a comparator's or switch's delay). Not
  /// rate-independent then.
  double switch_delay_s = 0.0;
  /// slope_sign only: added to x + d(x) on each branch (offsets of the multipliers that make the powers).
  double constant_ascending = 0.0;
  double constant_descending = 0.0;

  /// From the parameters of polynomial_hysteresis or of sine_hysteresis.
  static PolynomialDisturbance from(const Parameters& values);

  // Rule of NestedLoops.
  struct Cache {};
  using Turn = LoopTurn<Cache>;
  Cache cache(double) const { return {}; }
  double output(const Turn& from, const Turn* toward, int direction, double x) const;
  double input(const Turn& from, const Turn* toward, int direction, double y, double now) const;
  /// x + d(x) of the slope_sign rule.
  double plain(bool rising, double x) const;
  /// The input that gives y on that branch of the slope_sign rule; the nearest one where y is beyond what the branch
  /// reaches. Outside the stroke a cubic turns sooner or later: an input beyond its turn, where it falls, is none.
  double input_on(bool rising, double y) const;

 private:
  /// One branch of the slope_sign rule, y = x + gain d(x/amplitude) + constant.
  struct PlainBranch {
    const BranchShape& shape;
    double gain, amplitude, constant;
    double value(double x) const;
    /// The input of y by Newton's steps from y on; nothing where they do not settle at once.
    std::optional<double> newton(double y) const;
    /// The inputs about the stroke over which value() rises.
    std::array<double, 2> rising_part() const;
  };
  PlainBranch plain_branch(bool rising) const;
};

class PolynomialOperator final : public Operator {
 public:
  explicit PolynomialOperator(PolynomialDisturbance model);
  double reset(double u) override;
  double step(double u, double dt_s) override;
  double peek(double u, double dt_s) const override;
  bool rate_independent() const override { return !late(); }

 private:
  bool late() const { return !loops_.rule().nested && loops_.rule().switch_delay_s > 0.0; }
  NestedLoops<PolynomialDisturbance> loops_;
  double u_ = 0.0;
  bool rising_ = true;  ///< the input's direction
  bool branch_ = true;  ///< what the late switch stands at: true for ascending
  /// Seconds until the switch follows each turn that it has not followed yet, oldest first.
  std::array<double, 32> due_{};
  std::size_t waiting_ = 0;
  friend class PolynomialInverse;
};

class PolynomialInverse final : public Inverse {
 public:
  /// Throws DesignError when a branch falls somewhere on [0, 1].
  explicit PolynomialInverse(PolynomialDisturbance model);
  double reset(double y) override;
  double step(double y, double dt_s) override;

 private:
  PolynomialOperator forward_;
  double y_ = 0.0;
  bool rising_ = true;
};

/// With cubics (polynomial_hysteresis) or half sines.
Identified identify_polynomial(std::span<const TimeRecord> records, const IdentifyOptions& options,
                               bool sine);

}  // namespace bodesmith::hysteresis
