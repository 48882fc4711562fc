#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "chain/chain.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {

/// One block with its kernel, rebuilt only when a parameter changed. The one before is kept: differences move a parameter and
/// put it back.
class KernelSlot {
 public:
  /// Whether it is another one now.
  bool refresh(const chain::Block& block);
  chain::Kernel& kernel() { return *now_.kernel; }
  const chain::Kernel& kernel() const { return *now_.kernel; }

 private:
  struct Built {
    std::optional<chain::Kernel> kernel;
    std::vector<double> values;  ///< of the block's parameters when it was built

    bool is_of(const chain::Block& block) const;
  };
  Built now_;
  Built before_;
};

/// Neighbouring linear blocks, or one block of another kind.
///
/// The delays of a linear run are moved to its end, where they are exact. What does not come from the input
/// must not be delayed with it: constants of blocks behind a delay run alongside, in a system of their own.
struct RecordStage {
  std::size_t first = 0;  ///< block
  bool linear = false;
  chain::LinearKernel merged;
  chain::LinearKernel undelayed;  ///< driven by constants only; its states are those behind the delay
};

/// The first `blocks` blocks as stages.
std::vector<RecordStage> record_stages(const std::vector<KernelSlot>& slots, std::size_t blocks);

/// The holds of a record, and behind which of them each sample interval ends.
struct HoldPlan {
  std::vector<HoldSpan> spans;
  std::vector<std::size_t> ends;
};

/// `oversample` holds to a sample interval. Where a switch acts late one ends there, and that interval, the next and that of the turn
/// are of shorter ones: a jump inside a hold is right for dynamics slow compared with the hold (BranchPropagator); quick ones, and the turns that they make
/// for a memory behind them, need a hold that ends with the jump, and holds as short as they are. Turns of the input itself count.
HoldPlan plan_holds(const std::vector<RecordStage>& stages, const std::vector<KernelSlot>& slots,
                    std::span<const double> u, double step_s, std::size_t oversample);

/// 1 while every signal that enters dynamics is a straight line over each hold of h seconds, else 3.
std::size_t needed_degree(const std::vector<RecordStage>& stages, const std::vector<KernelSlot>& slots,
                          double h);

}  // namespace bodesmith::simulate
