#pragma once

#include <vector>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {

/// Whether a block may be part of an ODE: everything but pure delays, clocked blocks and memory that depends
/// on the rate.
bool can_stand_in_ode(const chain::Kernel& kernel);

/// The whole chain in CVODE. Runs of blocks that are an ODE are solved as one (ode_run.hpp); between them
/// stand pure delays, clocked blocks (edge by edge) and memory that depends on the rate (stepped eight times
/// a sample, said in the notes), which work on the dense signal the run before them left.
std::vector<double> run_cvode_engine(const chain::Chain& chain, const TimeRecord& input,
                                     const Options& options, Stats& stats, std::vector<std::string>& notes,
                                     double& model_error);

}  // namespace bodesmith::simulate
