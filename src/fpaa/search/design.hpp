#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "fpaa/cams/filter_stage.hpp"
#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// One stage of a design while it is searched: capacitors that need not be whole yet, wired to other stages.
struct DesignStage : FilterStage {
  std::string name;
  std::int64_t divisor = 1;  ///< of the master clock
  std::vector<int> from;     ///< what feeds each input: a stage before this one, or kBoardInput
  bool whole = false;        ///< its capacitors are whole units: nothing in it is fitted any more

  static constexpr int kBoardInput = -1;

  /// That the continuous fit may move it (the others only fix the stage's scale).
  bool is_free(std::size_t capacitor) const;
};

/// Stages in an order in which each reads only those before it; the last drives the output pin. No stage reads a slower
/// one, and the periods of two clocks that meet have an even ratio: then whatever a slower clock sees of a
/// faster one repeats within each of its own phases, and sine_response.hpp is exact.
struct Design {
  std::vector<DesignStage> stages;
  int opamps() const;
  /// Stage `stage`'s output times `factor`, and whatever reads it divided by it: the response stays.
  void scale_node(std::size_t stage, double factor);
};

/// To a millionth: what two processors make of one search differs in the last digits, and what is chosen from it should not.
double snapped(double value);
/// Figures nearer to one another than this share of them are the same: rounding is some 1e-13 of what is compared.
inline constexpr double kSame = 1e-9;

/// A finished design (whole capacitors) as CAMs on chips with clocks, places, wires and pins; without errors,
/// notes and headroom. A stage goes to the chip of what it reads if there is room (op-amps and capacitors in
/// one CAB, at most six clocks of one system divisor, seven pins a chip), else to the next that has it. Refused
/// when the board is too small.
Outcome<Plan> plan_of_design(const Design& design, const Board& board);

}  // namespace bodesmith::fpaa
