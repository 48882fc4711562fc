#pragma once

#include <optional>

#include "chain/chain.hpp"
#include "cli/command_line.hpp"
#include "signal/time_record.hpp"
#include "simulate/controller_file.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::cli {

/// The input of a simulation, and the frequency at which it repeats when that is known.
struct SimulationInput {
  TimeRecord record;
  std::optional<Hertz> fundamental;
};

void add_input_options(CommandLine& line);
/// --input (its r in a loop), or the reference that --reference describes.
SimulationInput read_input(const CommandLine& line, bool loop, Provenance& from);

/// `simulate --sweep-frequency-hz`: a table of tracking figures over frequency and amplitude.
void add_sweep_options(CommandLine& line);
int simulate_sweep(const CommandLine& line, const chain::Chain& model,
                   const std::optional<simulate::LoopSetup>& loop, const Provenance& from,
                   const simulate::Options& simulation);

}  // namespace bodesmith::cli
