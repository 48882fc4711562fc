#pragma once

#include "fpaa/device/board.hpp"
#include "fpaa/search/sine_response.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// `points` a decade over the band, and beyond it a few that count little: the response outside is not judged, but should not
/// run away either.
DesignTarget design_target(const Sections& sections, Band band, double points, const Board& board);

/// With points near the multiples of the design's clocks that lie within the band: a sampled response repeats there, a pole
/// of width p leaves a feature of that width.
DesignTarget with_clocks_seen(DesignTarget target, const Design& design, const Sections& sections);

/// The frequency (rad/s) about which a stage turns at its clock, by its feedback capacitors.
double corner_of(const DesignStage& stage, double master_hz);

}  // namespace bodesmith::fpaa
