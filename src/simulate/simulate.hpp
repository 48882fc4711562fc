#pragma once

#include "chain/chain.hpp"
#include "signal/time_record.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// The output of a chain for a sampled input, which is a straight line between samples. An InputError when
/// the chain cannot be simulated (a model without blocks is the identity, and can).
Result simulate(const chain::Chain& chain, const TimeRecord& input, const Options& options = {});
/// The same for samples that lie elsewhere (in another language's arrays). The record engine without an error estimate
/// reads them where they lie; everything else makes a record of them.
Result simulate(const chain::Chain& chain, const SampledInput& input, const Options& options = {});

}  // namespace bodesmith::simulate
