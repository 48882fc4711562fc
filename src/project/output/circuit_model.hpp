#pragma once

#include <string>
#include <vector>

#include "chain/block.hpp"
#include "lti/sections.hpp"
#include "synthesis/circuit.hpp"

namespace bodesmith::project {

/// What one stage or CAM makes: a gain (an inverter), one section under one name ("Stage3"; "Stage3_gain" before it where the
/// block has none of its own), or a ladder's many real poles one after the other ("Stage3_1", "Stage3_2").
std::vector<chain::Block> stage_blocks(const Section& section, const std::string& name);

/// A circuit's stages with the parts they have, named "Stage1" …, op-amps as fast as they are: each moves its section's poles
/// and adds one ("Stage1_opamps"), to the first order of 1/(gain-bandwidth); of complex ones the section is fitted to the network.
/// What their capacitors and op-amps do (Block::parts) is told of each but ladders and those with an integrator and another pole; their op-amps, and integrators', are ideal.
std::vector<chain::Block> circuit_blocks(synthesis::Circuit circuit);

}  // namespace bodesmith::project
