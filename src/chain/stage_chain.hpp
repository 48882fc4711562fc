#pragma once

#include "chain/chain.hpp"
#include "lti/cascade.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::chain {

/// A fractional_lead_lag a term, named "Term1" …, behind the gain.
Chain chain_of(const Cascade& cascade);
/// y = x + K(f) d(x) by the slope of x, K at `operating` (0: without rate gains); named "stage".
Block stage_block(const Disturbance& disturbance, Hertz operating);

}  // namespace bodesmith::chain
