#pragma once

#include "chain/kernel.hpp"
#include "signal/time_record.hpp"
#include "simulate/dense_signal.hpp"

namespace bodesmith::simulate {

// Blocks that cannot stand in an ODE, from one dense signal to the next.

/// y(t) = u(t - delay); what was before the signal's begin comes first.
DenseSignal delayed(const DenseSignal& in, double delay_s);

/// A memory that depends on the rate, moved along straight lines of at most `max_step_s`.
DenseSignal stepped(chain::MemoryKernel& memory, const DenseSignal& in, double max_step_s, bool equilibrium);

/// A clocked block, edge by edge. Edges that are samples of the record but for rounding are those exactly.
DenseSignal clocked(chain::SampledKernel& kernel, const DenseSignal& in, bool equilibrium,
                    const TimeRecord& record);

}  // namespace bodesmith::simulate
