#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "chain/kernel.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::simulate {

/// A signal that stands between edges: value[i] from at[i] on, in holds of equal length; at[0] = 0.
struct StepSignal {
  std::vector<double> at;
  std::vector<double> value;
};

/// Runs a clocked kernel over the input u, given at the nodes of `holds` holds of length h.
void run_sampled(chain::SampledKernel& kernel, const HoldNodes& nodes, double h, const double* u,
                 std::size_t holds, bool equilibrium, StepSignal& out);

/// A memory that does not depend on the rate of its input, in place: steps stay steps. `rest`: what the input rested at before
/// the start, if it did. Returns the output there.
double run_memory(chain::MemoryKernel& memory, StepSignal& signal, std::optional<double> rest);
/// Of a memory that may be moved in no time but takes its time: its output at the nodes of holds of length h.
double run_memory(chain::MemoryKernel& memory, const StepSignal& signal, const HoldNodes& nodes, double h,
                  std::size_t holds, std::optional<double> rest, double* y);

/// The values at the nodes. Where edges fall inside a hold and `jumps` is given (as long as y), y is instead the polynomial
/// with the same moments over the hold, so that the states of a linear system behind it see the right steps to high order;
/// `jumps` is what the signal at the nodes is more than that.
void spread_steps(const StepSignal& signal, const HoldNodes& nodes, double* y, std::size_t holds,
                  double* jumps);

/// A memory operator node by node, in place. Returns the output at the start.
double run_memory(chain::MemoryKernel& memory, const HoldNodes& nodes, std::span<const HoldSpan> spans,
                  double* signal, std::optional<double> rest);

}  // namespace bodesmith::simulate
