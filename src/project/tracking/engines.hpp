#pragma once

#include <string>
#include <vector>

#include "project/tracking/tracked_designs.hpp"

namespace bodesmith::project {

/// Both forms of the circuit, one pass and self-fed, by the response that ngspice finds of its netlist at every harmonic, beside
/// itself by its own response. Without ngspice the latter alone, without a circuit nothing.
tracking::Report circuit_by_ngspice(const Project& project, const Design& design,
                                    const std::vector<TrackedCandidate>& candidates);

/// Of a study that is complete but for them: the analog controller, the circuit and the board (the better of one pass and
/// self-fed), the best controller on the board. `followed`: by CVODE, checked by harmonics.
std::vector<EngineRow> engine_rows(const TrackingStudy& study, const tracking::Report& followed,
                                   const tracking::Report& by_ngspice);

/// Head and rows of texts, for a terminal or a page.
std::vector<std::vector<std::string>> engine_table(const std::vector<EngineRow>& rows);

}  // namespace bodesmith::project
