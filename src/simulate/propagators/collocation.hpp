#pragma once

#include <cstddef>
#include <vector>

#include "chain/kernel.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {

/// x' = A x + b u + e n(x, u) over holds of equal length: n is the polynomial through its values at the
/// hold's nodes (Lobatto collocation of degree 3, order 6 in the step), its linear surroundings exact. The implicit
/// equations are solved by a simplified Newton iteration; a hold in which that does not contract, or over
/// which the linear part turns too far, is halved, as often as needed (at most 2^12 parts).
class CollocationPropagator {
 public:
  struct Limits {
    /// Parts a hold, on the average of a run and beyond what the linear part asks for, at which it is given
    /// up.
    double max_parts = 64.0;
    /// Turn of the linear part over one step, in rad, above which a hold is halved from the start.
    double max_turn_rad = 0.75;
    /// Newton's iteration ends when the forces are right to this share of their size.
    double tolerance = 1e-13;
  };
  enum class Outcome {
    finished,
    too_many_parts,  ///< halved beyond all measure: a state that runs away
    not_finite,      ///< a hold did not converge even at the finest level
  };

  /// A system of one state or two.
  void prepare(const chain::OdeKernel& system, double h, const Limits& limits);
  /// u and y: hold_nodes(3) of each hold. Unless finished, outputs from where it was given up are 0.
  Outcome run(const chain::OdeKernel& system, const double* u, double* y, std::size_t holds, double* x);

 private:
  static constexpr std::size_t kDegree = 3, kWidth = kDegree + 1;
  /// Everything for one length of step.
  struct Level {
    bool ready = false;
    std::vector<double> e;   // per node 1..3: order x order
    std::vector<double> gu;  // per node: order x 4
    std::vector<double> ge;  // per node: order x 4
    std::vector<double> k;   // per node: order
  };
  const Level& level(const chain::OdeKernel& system, std::size_t index);
  /// One step of h/2^index; `states_` then holds x at every node. False when the iteration does not contract.
  bool step(const chain::OdeKernel& system, const Level& matrices, const double* u, const double* x);
  template <std::size_t Order>
  bool step_sized(const chain::OdeKernel& system, const Level& matrices, const double* u, const double* x);
  /// Interpolation weights of one part of a hold, row by row: the input at the part's nodes from the hold's,
  /// and the states at the hold's nodes from `first` to below `end` (those that lie in the part) from the
  /// part's.
  struct Part {
    std::size_t first = 0;
    std::size_t end = 0;
    double inward[kWidth * kWidth];
    double outward[kWidth * kWidth];
  };
  Part make_part(std::size_t index, double from) const;
  /// The same from a table for the coarse levels, into `made` for the others.
  const Part& part(std::size_t index, double from, Part& made) const;
  /// Covers the part [from, from + 2^-index] of the hold with node values u; fills outputs whose node lies in
  /// it.
  void cover(const chain::OdeKernel& system, std::size_t index, double from, const double* u, double* x,
             double* y);
  /// Outputs of a whole hold (no part), or of the part's own nodes, from states_.
  void write_outputs(const StateSpace& linear, const Part* part, const double* u, double* y) const;

  static constexpr std::size_t kFinest = 12;
  static constexpr std::size_t kTabled = 4;  ///< levels with a table
  Limits limits_;
  double h_ = 0.0;
  std::size_t order_ = 0;
  std::size_t first_level_ = 0;
  const HoldNodes& nodes_ = hold_nodes(kDegree);
  std::vector<Part> parts_;  ///< levels 1 to kTabled, 2^index each
  std::vector<Level> levels_;
  HoldResponseSolver solver_;
  HoldResponse response_;
  std::vector<double> states_;  // 4 x order
  std::vector<double> base_;
  std::vector<double> gradient_;
  std::vector<double> force_;  // 4
  Outcome outcome_ = Outcome::finished;
  double steps_left_ = 0.0;
};

}  // namespace bodesmith::simulate
