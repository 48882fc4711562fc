#pragma once

#include <cstddef>
#include <vector>

#include "chain/kernel.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {

/// y = P(u), P one of two polynomials by the direction of u some time earlier, over holds of equal length.
///
/// Turns are found where they are, as the roots of the slope of the input's polynomial, and the switch acts
/// at its own time. A hold in which it does so cannot be a polynomial: its nodes are set so that both ends
/// are exact and the moments ∫ s^m y ds, m = 0 … p - 2, are those of the broken curve, so dynamics that
/// follow see the jump where it is up to order p in the hold (ends alone would leave order 1).
class BranchPropagator {
 public:
  /// False: this operator is not of that kind.
  bool prepare(const chain::MemoryKernel& memory, double h, const HoldNodes& nodes);
  /// In place. Rests under the constant `before` until the first hold; returns the output there.
  double run(double* signal, std::size_t holds, double before);

 private:
  double on_branch(double u) const;
  void turn(double when, bool rising);
  bool is_constant(const double* v) const;
  /// Turns inside the hold, and at its begin, where the input came from `last`.
  void find_turns(const double* v, std::size_t hold, double last, double noise);
  void broken_hold(double* v, std::size_t hold);
  /// Moments 0 ... p - 2 of the output over the hold; the switch then stands as at its end.
  void moments(const double* v, std::size_t hold, double* moment);
  /// Inner nodes of v so that it has these moments; its ends stand.
  void solve_inner_nodes(const double* moment, double* v) const;

  const HoldNodes* nodes_ = nullptr;
  std::vector<double> up_;
  std::vector<double> down_;
  double delay_ = 0.0;       ///< in holds
  bool rising_ = true;       ///< direction of the input
  bool branch_ = true;       ///< what the switch stands at
  std::vector<double> due_;  ///< times at which the switch will toggle, in holds
  double quadrature_[kMaxDegree + 1] = {};
};

}  // namespace bodesmith::simulate
