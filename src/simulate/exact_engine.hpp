#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::simulate {

/// A chain whose signal stays a polynomial of time between the corners of its input until it meets linear
/// dynamics: gains and straight sources, then at most one polynomial curve or one hysteresis of polynomial
/// branches, then linear blocks and delays, by the modes of the linear part (exact_propagator.hpp).
struct ExactOutcome {
  std::vector<double> y;
  double rounding = 0.0;  ///< what rounding may have done to y
  double model_error = 0.0;
  std::size_t segments = 0;
};

/// Nothing, and in `why_not` a reason, when the chain or the input is not of that kind (an input with a
/// corner at nearly every sample is not: the record engine does it faster).
std::optional<ExactOutcome> run_exact_engine(const chain::Chain& chain, const TimeRecord& input, Start start,
                                             bool any_input, std::string& why_not);

}  // namespace bodesmith::simulate
