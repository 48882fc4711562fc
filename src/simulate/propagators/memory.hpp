#pragma once

#include <cstddef>

#include "chain/kernel.hpp"
#include "simulate/hold_nodes.hpp"

namespace bodesmith::simulate {

/// A memory operator over holds of h seconds, node by node, in place. Returns the output at the start.
double run_memory(chain::MemoryKernel& memory, const HoldNodes& nodes, double h, double* signal,
                  std::size_t holds, bool equilibrium);

}  // namespace bodesmith::simulate
