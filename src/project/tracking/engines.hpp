#pragma once

#include <string>
#include <vector>

#include "project/tracking/board_in_time.hpp"

namespace bodesmith::project {

/// Both forms of the circuit, one pass and self-fed, followed harmonic by harmonic.
struct CircuitTracked {
  tracking::Report by_parts;    ///< by the response of its parts and op-amps; empty without a circuit
  tracking::Report by_ngspice;  ///< by the response that ngspice finds of its netlist; empty without ngspice
  std::string missing;          ///< why there is neither
};
CircuitTracked track_circuit(const Project& project, const Design& design,
                             const std::vector<TrackedCandidate>& candidates);

/// Of a study that is complete but for them: the analog controller, the circuit and the board (the better of one pass and
/// self-fed), the best controller on the board: `boards` are those two. `followed`: by CVODE, checked by harmonics.
std::vector<EngineRow> engine_rows(const TrackingStudy& study, const tracking::Report& followed,
                                   const CircuitTracked& circuit, const std::vector<BoardsInTime>& boards);

/// A sentence for each row whose engines are further apart than they should be where both are right, or whose closed form leaves out
/// more than that.
std::vector<std::string> engine_warnings(const std::vector<EngineRow>& rows);

report::Table engine_table(const std::vector<EngineRow>& rows);

}  // namespace bodesmith::project
