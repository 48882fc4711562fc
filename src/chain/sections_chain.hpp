#pragma once

#include <string>

#include "chain/chain.hpp"
#include "lti/cascade.hpp"
#include "lti/sections.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::chain {

/// The same H(s) as blocks: a gain, then a block a real pole (lowpass, highpass, pole_zero, right_half_plane_zero, integrator)
/// and one a pair of complex ones or of real ones below complex zeros (resonator, biquad), then the delay. Blocks other
/// than integrators have a gain of 1 at DC where they have any. A pole at 0 that shares a section with complex zeros stands
/// 1e-12 of its neighbour's corner from 0.
/// With a `prefix` the blocks are named: "Section2", "Section2a" and "Section2b" of a section that takes two, "Section_gain".
Chain chain_of(const Sections& sections, const std::string& prefix = {});

/// A section of two poles, whatever they are, as one `biquad`, its gain in it.
Block biquad_of(const Section& section);

/// A fractional_lead_lag a term, named "Term1" …, behind the gain.
Chain chain_of(const Cascade& cascade);
/// y = x + K(f) d(x) by the slope of x, K at `operating` (0: without rate gains); named "stage".
Block stage_block(const Disturbance& disturbance, Hertz operating);

}  // namespace bodesmith::chain
