#pragma once

#include <cstddef>

#include "chain/kernel.hpp"
#include "simulate/hold_nodes.hpp"

namespace bodesmith::simulate {

/// Runs a clocked kernel over holds of equal length h. Where clock edges fall inside a hold, `point_values`
/// true gives the output at the nodes; false gives the polynomial with the same moments over the hold, so
/// that a linear system behind it sees the right steps to high order.
void run_sampled(chain::SampledKernel& kernel, const HoldNodes& nodes, double h, const double* u, double* y,
                 std::size_t holds, bool equilibrium, bool point_values);

}  // namespace bodesmith::simulate
