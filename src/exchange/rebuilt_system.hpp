#pragma once

#include <string>
#include <vector>

#include "lti/state_space.hpp"

namespace bodesmith::exchange {

/// A linear block of a model, y = c x + d u of x' = A x + b u, then delayed.
struct ChainBlock {
  std::string name;
  StateSpace system;
  double delay_s = 0.0;
};

/// A block of a board, sampled at its own clock: sum over inputs of numerator(z)/denominator(z) times what feeds it, in ascending
/// powers of 1/z; z = exp(j w / clock).
struct SampledBlock {
  struct Input {
    std::string from;  ///< name of a block; empty: the network's input
    std::vector<double> numerator;
  };
  std::string name;
  double clock_hz = 0.0;
  std::vector<Input> inputs;
  std::vector<double> denominator;
};

/// Sampled blocks in an order in which each stands behind those that feed it.
struct SampledNetwork {
  std::vector<SampledBlock> blocks;
  std::string output;  ///< name of the block that is the output
};

}  // namespace bodesmith::exchange
