#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "chain/kernel.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {

/// y = f(u), f one of two curves by the direction of u some time earlier (MemoryKernel::has_branches).
///
/// Turns are found where they are, as the roots of the slope of the input's polynomial, and the switch acts
/// at its own time. A hold in which it does so cannot be a polynomial: its nodes are set so that both ends
/// are exact and the moments ∫ s^m y ds, m = 0 … p - 2, are those of the broken curve, so dynamics that
/// follow see the jump where it is up to order p in the hold (ends alone would leave order 1).
class BranchPropagator {
 public:
  /// What stands in front and behind.
  struct Place {
    /// Between the nodes the input may have corners near which the polynomial overshoots: a turn that nodes do not show counts
    /// where the next hold goes on from it.
    bool kinked = false;
    /// Of the output the values at the nodes count.
    bool values_only = false;
  };
  /// In place. Rests under the constant `before` until the first hold; returns the output there.
  double run(const chain::MemoryKernel& memory, const HoldNodes& nodes, std::span<const HoldSpan> spans,
             double* signal, double before, Place place);

 private:
  double on_branch(double u) const;
  void turn(double when, bool rising);
  bool is_constant(const double* v) const;
  /// Turns inside the hold, and at its begin, where the input came from `last`. `next`: the hold behind it, or null.
  void find_turns(const double* v, double last, double noise, const double* next);
  /// Whether the nodes go one way.
  bool is_monotone(const double* v) const;
  void run_hold(double* v);
  void broken_hold(double* v);
  void values_of_broken_hold(double* v);
  /// The switch as it stands at `at`.
  void switch_until(double at);
  /// Moments 0 ... p - 2 of the output over the hold; the switch then stands as at its end.
  void moments(const double* v, double* moment);
  /// Inner nodes of v so that it has these moments; its ends stand.
  void solve_inner_nodes(const double* moment, double* v) const;

  const chain::MemoryKernel* memory_ = nullptr;
  const HoldNodes* nodes_ = nullptr;
  Place place_;
  double delay_ = 0.0;       ///< in holds
  bool rising_ = true;       ///< direction of the input
  bool branch_ = true;       ///< what the switch stands at
  std::vector<double> due_;  ///< times at which the switch will toggle, in holds from the begin of this one
  double quadrature_[kMaxDegree + 1] = {};
};

}  // namespace bodesmith::simulate
