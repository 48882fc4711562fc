#pragma once

#include <memory>
#include <span>

#include "hysteresis/model_type.hpp"
#include "hysteresis/preisach.hpp"

namespace bodesmith::hysteresis {

/// The Krasnoselskii-Pokrovskii model and its rate-dependent form (KP paper, eq. 1-7), v = (u − u_min)/(u_max −
/// u_min):
///   k_p[v, ξ] = max(ξ, s(v − p2)) while v rises, min(ξ, s(v − p1)) while it falls,  p1 ≤ p2     (4), (5)
///   s(x) = 0 for x < 0, x/a on [0, a], 1 above                                                  (6)
///   y = offset + ψ Σ μ(p2, p1) k_p[v],     ψ = a1 e^(−a2 u̇)                                     (2), (3), (7)
/// on the grid p = 0, a, 2a, …, a = 1/(L − 1). With u̇ in the input's unit per second a2 has the unit s/u: the
/// printed 2.5·10⁷ cannot be meant in V/s (e^(−9·10¹¹) at 100 Hz); 2.5·10⁻⁷ s/V gives the printed trend. a1 =
/// 1, a2 = 0: classic KP. Kernels with p2 = 1 never move on [0, 1] and are left out: L − 1 = `levels` rows, μ
/// in the order of Preisach's w.
///
/// A KP kernel is a relay spread evenly along the diagonal of its cell, so KP has an Everett function: for
/// ends in the cells (i, f) above and (j, g) below, with T the node sums as in EverettTable (0 above the
/// diagonal)
///   E = T(i, j+1) + f [T(i+1, j+1) − T(i, j+1)] + (1 − g) [T(i, j) − T(i, j+1)] + max(0, f − g) μ(i, j),
/// and the same stack of turning points serves: O(1) a sample for any number of kernels, exact inverse by
/// search among nodes and a piecewise linear equation.
/// The paper's recursive inverse (eq. 13, 14) is RecursiveInverse.
/// With a2 ≠ 0 a sample-by-sample inverse exists only while a2 H < dt dH/du: at a short sampling time ψ makes
/// the output fall when the input rises, and every search (the paper's too) runs away. KpRateInverse takes
/// the slope in ψ from the static inverse of the reference instead, a lead that is stable at any sampling
/// time; its error is of second order in a2.
class KpEverett : public TableRule<KpEverett> {
 public:
  explicit KpEverett(std::shared_ptr<const EverettTable> table) : TableRule(std::move(table)) {}
  double everett(const TablePlace& high, const TablePlace& low) const {
    const double* row = data_ + static_cast<std::ptrdiff_t>(high.cell) * (cells_ + 1) + low.cell;
    const double* next = row + cells_ + 1;
    const double corner = high.fraction > low.fraction ? high.fraction - low.fraction : 0.0;
    return row[1] + high.fraction * (next[1] - row[1]) + (1.0 - low.fraction) * (row[0] - row[1]) +
           corner * (next[0] - row[0] - next[1] + row[1]);
  }
  double input(const Turn& from, const Turn* toward, int direction, double y, double now) const;
};

struct KrasnoselskiiPokrovskii {
  std::shared_ptr<const EverettTable> table;  ///< 0 above the diagonal
  double offset = 0.0;
  double a1 = 1.0;
  double a2 = 0.0;

  static KrasnoselskiiPokrovskii from(const Parameters& values);
};

class KpOperator final : public Operator {
 public:
  explicit KpOperator(const KrasnoselskiiPokrovskii& model);
  double reset(double u) override;
  double step(double u, double dt_s) override;
  double peek(double u, double dt_s) const override;
  bool rate_independent() const override { return a2_ == 0.0; }

 private:
  double rate(double u, double dt_s) const;
  EverettOperator<KpEverett> static_;
  double offset_;
  double a1_;
  double a2_;
  double u_ = 0.0;
};

/// See above.
class KpRateInverse final : public Inverse {
 public:
  explicit KpRateInverse(const KrasnoselskiiPokrovskii& model);
  double reset(double y) override;
  double step(double y, double dt_s) override;

 private:
  EverettInverse<KpEverett> slow_;  ///< static inverse of the reference: gives the slope
  EverettInverse<KpEverett> fast_;  ///< the one that drives
  KpOperator forward_;
  double offset_;
  double a1_;
  double a2_;
  double slow_u_ = 0.0;
};

Identified identify_krasnoselskii_pokrovskii(std::span<const TimeRecord> records,
                                             const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
