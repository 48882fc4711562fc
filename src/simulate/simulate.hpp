#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

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

/// Neighbouring blocks that an engine works out together, and how.
struct Segment {
  std::size_t first = 1;  ///< blocks count from 1
  std::size_t last = 1;
  std::string_view method;
};

/// How an engine (Stats::engine) cuts a chain up. Each cut is a choice by what the blocks are: linear ones by
/// the matrix exponential, smooth nonlinear ones by collocation, memory step by step, and so on.
std::vector<Segment> segments_of(const chain::Chain& chain, Engine engine);

}  // namespace bodesmith::simulate
