#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "chain/chain.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

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
