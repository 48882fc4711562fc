#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "hysteresis/model_type.hpp"

namespace bodesmith::hysteresis {

/// The Prandtl-Ishlinskii model (Krasnosel'skii and Pokrovskii 1983; asymmetric form after Kuhnen, European
/// Journal of Control 9 (2003) 407; envelope after Al Janaideh, Rakheja and Su, IEEE/ASME Trans. Mechatronics
/// 16 (2011) 734).
///   play:        z_i(t) = max(v − r_i, min(v + r_i, z_i(t⁻))),        0 = r_0 < r_1 < …     (units of v)
///   bank:        p(t)   = Σ w_i z_i + Σ e_i max(0, v − z_i),          w_0 > 0, Σ_{j≤i} w_j + Σ_{j>i} min(0, e_j) > 0
///   dead zones:  S(p)   = p + Σ_k v_k d(p, s_k),  d(p, s) = max(p − s, 0) for s > 0, min(p − s, 0) for s < 0
///   envelope:    v      = γ(u − u_0), γ(x) = c0 tanh(c1 x + c2) + c3 when `gamma` is given, else v = u − u_0
///   output:      y      = offset + S(p).
/// Without dead zones and e the loops are centrally symmetric. Rate-independent; wiping-out holds, and without e
/// congruency for v → p. v − z_i is the stop of play i: e_i says how much more it weighs above zero than below, as of friction that
/// holds harder one way (stops and plays: Brokate and Sprekels, Hysteresis and Phase Transitions, 1996, ch. 2).
///
/// Analytic inverse of models without e (Kuhnen): v = w'_0 p + Σ w'_i play_{r'_i}(p), with
///   r'_i = Σ_{j≤i} w_j (r_i − r_j),  w'_0 = 1/w_0,  w'_i = −w_i / (Σ_{j≤i} w_j · Σ_{j<i} w_j),
/// states z'_i = Σ_{j≤i} w_j z_i + Σ_{j>i} w_j z_j; S⁻¹ is piecewise linear; γ⁻¹ in closed form.
struct PrandtlIshlinskii {
  std::vector<double> r;
  std::vector<double> w;
  std::vector<double> s;  ///< dead-zone thresholds, any order, none 0
  std::vector<double> v;
  std::vector<double> e;      ///< empty, or as many as w
  std::vector<double> gamma;  ///< empty or {c0, c1, c2, c3}
  double u_0 = 0.0;
  double offset = 0.0;
  /// What reset() takes for the past: rest at u_0, or a monotone motion from far above or far below.
  enum class Start { rest_zero, from_above, from_below } start = Start::rest_zero;

  static PrandtlIshlinskii from(const Parameters& values);

  double envelope(double u) const;
  double envelope_inverse(double v) const;
  double shape_inverse(double y) const;
};

/// The words of `start` in model.toml.
std::string_view to_string(PrandtlIshlinskii::Start start);

class PrandtlIshlinskiiOperator final : public Operator {
 public:
  explicit PrandtlIshlinskiiOperator(PrandtlIshlinskii model);
  double reset(double u) override;
  double step(double u, double dt_s) override;
  double peek(double u, double dt_s) const override;
  bool rate_independent() const override { return true; }
  /// The plays' states, for tests.
  const std::vector<double>& states() const { return z_; }

 private:
  struct DeadZone {
    double s = 0.0, v = 0.0;
  };
  /// S(p): what lies on the other side of 0 adds nothing.
  double shape(double p) const;

  PrandtlIshlinskii model_;
  std::vector<double> z_;
  std::vector<DeadZone> above_, below_;  ///< 0
};

class PrandtlIshlinskiiInverse final : public Inverse {
 public:
  explicit PrandtlIshlinskiiInverse(PrandtlIshlinskii model);
  double reset(double y) override;
  double step(double y, double dt_s) override;

 private:
  PrandtlIshlinskii model_;
  std::vector<double> r_;                             ///< r'
  std::vector<double> w_;                             ///< w'
  std::vector<double> z_;                             ///< z'
  std::optional<PrandtlIshlinskiiOperator> forward_;  ///< only with an envelope, which can run out of reach
};

Identified identify_prandtl_ishlinskii(std::span<const TimeRecord> records, const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
