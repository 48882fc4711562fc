#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "chain/chain.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

struct RecordOptions {
  std::optional<Start> start;  ///< nothing: as the chain says, zero where it does not
  std::size_t oversample = 1;  ///< holds a sample interval
  double start_s = 0.0;
  /// A run whose nonlinear dynamics need more parts a hold than this (on the average, beyond what their
  /// linear part asks for) is given up as diverged. Searches through wild parameter values set it low.
  double max_parts = 64.0;
  /// Nonlinear dynamics: turn of the linear part over one step, in rad, above which a hold is halved; and the
  /// share of the forces at which Newton's iteration ends. Searches take them coarser.
  double max_turn_rad = 0.75;
  double newton_tolerance = 1e-13;
  /// Every run has the same input (samples that stay where they are and as they are): what lies
  /// in front of the first block that changed since the last run is not worked out again.
  bool same_input = false;
};

/// The record engine: a chain worked out from sample to sample, thousands of times with other parameters.
///
/// Each signal between blocks is a polynomial of degree p (1 where that is exact, else 3) over each hold (a sample interval or 1/oversample
/// of it), given by its values at the p+1 Gauss-Lobatto points; neighbouring holds may differ at their common
/// point, so jumps at samples are exact. Neighbouring linear blocks are merged into one state space and
/// propagated by its matrix exponential, exact for such an input, pure delays included; smooth nonlinear
/// dynamics by collocation at the same points with an exact linear part; memory operators point by point. So
/// a linear chain is exact at p = 1, and a curve followed by dynamics has an error of order p+1 in the step,
/// except where a kink falls inside a hold.
///
/// run() reuses every buffer. Use one object a thread.
class RecordSimulator {
 public:
  RecordSimulator(chain::Chain chain, double step_s, RecordOptions options = {});
  ~RecordSimulator();
  RecordSimulator(RecordSimulator&&) noexcept;
  RecordSimulator& operator=(RecordSimulator&&) noexcept;

  /// Change parameter values here between runs; adding blocks or list entries needs a new object.
  chain::Chain& chain();

  /// Output at every sample of u; the view stays good until the next run.
  std::span<const double> run(std::span<const double> u);
  /// The same, to keep: for a simulator that is used once.
  std::vector<double> run_once(std::span<const double> u);
  /// The output of the first `blocks` blocks instead (0: the input itself).
  std::span<const double> run_until(std::span<const double> u, std::size_t blocks);

  /// How the last run ended. Unless finished its output is finite but means nothing from some time on.
  enum class Outcome {
    finished,
    too_many_parts,  ///< nonlinear dynamics beyond RecordOptions::max_parts: an unstable spring
    not_finite,      ///< steps that did not converge however short
  };
  Outcome outcome() const;
  bool diverged() const { return outcome() != Outcome::finished; }

  std::size_t degree() const;
  double model_error() const;  ///< of the last run, see Result
  /// Where the last run, whose output was y, was exact but for rounding (degree 0, one hold a sample, and a chain that is linear where it has
  /// memory): what rounding may have done. Nothing where the step matters.
  std::optional<double> rounding_error(std::span<const double> y) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace bodesmith::simulate
