#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "base/units.hpp"
#include "chain/local_chain.hpp"
#include "simulate/types.hpp"

namespace bodesmith::invert {

struct Options {
  simulate::Start start = simulate::Start::equilibrium;
  /// Delays are made good by looking ahead in the reference; otherwise they stay in the output.
  bool preview = true;
  chain::DriveLimits limits;
  /// The drive holds nothing above it, but for what the limits make of it.
  std::optional<Hertz> bandwidth;
  int max_steps = 12;
};

/// A part of the reference that no drive reaches, and why.
struct OutOfReach {
  std::string why;
  std::size_t samples = 0;
  double from_s = 0.0;
  double to_s = 0.0;
};

}  // namespace bodesmith::invert
