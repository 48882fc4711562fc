#pragma once

#include <cstddef>
#include <span>

#include "chain/kernel.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {

/// Runs a clocked kernel over holds of equal length h: the output at the nodes. Where clock edges fall inside a hold and
/// `jumps` is given (as long as y), y is instead the polynomial with the same moments over the hold, so that the states of
/// a linear system behind it see the right steps to high order; `jumps` is what the output at the nodes is more than that.
void run_sampled(chain::SampledKernel& kernel, const HoldNodes& nodes, double h, const double* u, double* y,
                 std::size_t holds, bool equilibrium, double* jumps = nullptr);

/// A memory operator node by node, in place. Returns the output at the start.
double run_memory(chain::MemoryKernel& memory, const HoldNodes& nodes, std::span<const HoldSpan> spans,
                  double* signal, bool equilibrium);

}  // namespace bodesmith::simulate
