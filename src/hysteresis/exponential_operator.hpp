#pragma once

#include <span>
#include <vector>

#include "hysteresis/model_type.hpp"
#include "hysteresis/nested_loops.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

/// Exponential hysteresis operators with extreme stacks (exponential-operator paper, eq. 2-5):
///   L = Σ k_i (1 − e^(−τ_i |V − V_off|)) (V − V_off) + L_off                                        (eq. 2)
/// where (V_off, L_off) is the last turning point; conditions 1-4 (and Fig. 5) choose it:
///   1. at t = 0 it is (V_off(0), L_off(0)),
///   2. when the input turns, the turning point becomes (V_off, L_off), the former one goes on the stack,
///   3. when the input falls below the minimum a minor loop left from, the enclosing maximum is taken back,
///   4. when it rises above the maximum a minor loop left from, the enclosing minimum is taken back:
/// exactly NestedLoops. When no enclosing extreme is left the branch just goes on.
/// A branch depends on the distance from its turning point only, so the model is a Prandtl-Ishlinskii model
/// with the Everett function g(α − β), g(x) = Σ k_i (1 − e^(−τ_i x)) x: centrally symmetric loops,
/// congruency, return-point memory. The second-order dynamics of eq. 1 are a `resonator` block behind it.
/// Simplified to the dominant operator d (the smallest τ): L = (K − k_d e^(−τ_d |ΔV|)) ΔV + L_off, K = Σ k_i
/// (eq. 3). Inverse: exact, by Newton on the branch (outputs must rise: g' > 0); or as the paper does by
/// operators of the same form with V and L exchanged (eq. 4): identify on the exchanged record, see
/// exchanged(). Units: 10 µm where the text has "10 mm". The text's sensitivity gradient has a sign slip:
/// ∂L/∂k_d = −e^(−τ_d|ΔV|) ΔV.
struct ExponentialOperators {
  std::vector<double> k;
  std::vector<double> tau;
  double v_off = 0.0;
  double l_off = 0.0;

  static ExponentialOperators from(const Parameters& values);
  double gain_curve(double x) const;  ///< g(x), x ≥ 0
  double slope(double x) const;       ///< g'(x)
  /// x ≥ 0 with g(x) = y.
  double solve(double y) const;
  bool rises() const;
  /// Eq. 3, as two operators: K − k_d without lag (τ = 1e9 per unit of input), and the dominant one.
  ExponentialOperators dominant_only() const;

  // Rule of NestedLoops.
  struct Cache {};
  using Turn = LoopTurn<Cache>;
  Cache cache(double) const { return {}; }
  double output(const Turn& from, const Turn*, int direction, double u) const {
    return from.y + direction * gain_curve(direction * (u - from.u));
  }
  double input(const Turn& from, const Turn*, int direction, double y, double) const {
    return from.u + direction * solve(direction * (y - from.y));
  }
};

class ExponentialOperator final : public Operator {
 public:
  explicit ExponentialOperator(ExponentialOperators model);
  double reset(double u) override;
  double step(double u, double) override { return loops_.step(u); }
  double peek(double u, double) const override { return loops_.peek(u); }
  bool rate_independent() const override { return true; }

 private:
  NestedLoops<ExponentialOperators> loops_;
  friend class ExponentialInverse;
};

class ExponentialInverse final : public Inverse {
 public:
  /// Throws DesignError when g falls somewhere.
  explicit ExponentialInverse(ExponentialOperators model);
  double reset(double y) override;
  double step(double y, double) override { return forward_.loops_.invert(y); }
  double achieved() const override { return forward_.loops_.y(); }

 private:
  ExponentialOperator forward_;
};

/// The record with input and output exchanged: identifying it gives h_i, α_i of eq. 4.
TimeRecord exchanged(const TimeRecord& record);

Identified identify_exponential_operators(std::span<const TimeRecord> records,
                                          const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
