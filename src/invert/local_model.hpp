#pragma once

#include <vector>

#include "chain/chain.hpp"
#include "chain/local_chain.hpp"

namespace bodesmith::invert {

/// A chain near a drive: how it answers small changes, and how late.
struct LocalModel {
  chain::LocalChain chain;
  double delay_s = 0.0;  ///< of pure delays and clocked blocks
  double gain = 1.0;     ///< size of its slope
};
/// `signals`: the drive and the output of every block, at the samples.
LocalModel local_model(std::vector<chain::Kernel>& blocks, const std::vector<std::vector<double>>& signals,
                       double step_s);

/// All delays of the blocks.
double total_delay_s(const std::vector<chain::Kernel>& blocks);

}  // namespace bodesmith::invert
