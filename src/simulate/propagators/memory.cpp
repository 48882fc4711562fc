#include "simulate/propagators/memory.hpp"

namespace bodesmith::simulate {

double run_memory(chain::MemoryKernel& memory, const HoldNodes& nodes, double h, double* signal,
                  std::size_t holds, bool equilibrium) {
  const std::size_t width = nodes.size();
  double gaps[kMaxDegree + 1] = {};
  for (std::size_t j = 1; j < width; ++j) gaps[j] = h * (nodes.at[j] - nodes.at[j - 1]);
  const bool jumps = memory.jumps_at_turns();
  double* v = signal;
  double last_in = v[0];
  double last_out = memory.reset(v[0], equilibrium);
  const double rest = last_out;
  for (std::size_t hold = 0; hold < holds; ++hold, v += width) {
    if (v[0] != last_in) last_out = memory.step(v[0], 0.0);
    const double first = v[0];
    last_in = v[width - 1];
    if (jumps && v[1] != first) last_out = memory.departing(v[1]);
    v[0] = last_out;
    for (std::size_t j = 1; j < width; ++j) v[j] = memory.step(v[j], gaps[j]);
    last_out = v[width - 1];
  }
  return rest;
}

}  // namespace bodesmith::simulate
