#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "invert/compensation.hpp"

namespace bodesmith::invert {

/// From which sample on an error is that of tracking, not of starting.
struct SteadyState {
  std::size_t first = 0;
  std::string why;
};
/// The last whole period of a reference that repeats; otherwise everything behind the first sample, the chain's
/// delays and, from states that are zero, what it takes to forget them (half the record at most). With `skip_s`
/// whatever comes later than that.
SteadyState steady_state_of(const chain::Chain& chain, const TimeRecord& reference, const Options& options,
                            std::optional<double> skip_s);

}  // namespace bodesmith::invert
