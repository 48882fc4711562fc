#pragma once

#include <string>
#include <vector>

#include "project/tracking/tracked_designs.hpp"

namespace bodesmith::project {

/// A board as compensator, in time, at one frequency: the drive that ngspice makes with its board.sub and an ideal generator,
/// and the one that charge conservation (fpaa::BoardRun) makes of what ngspice's board read.
struct BoardInTime {
  double rms_percent = 0.0;         ///< what the stage makes of ngspice's drive, the best pure delay removed
  double difference_percent = 0.0;  ///< rms between both drives, of the stroke
};

/// The better of a board's two forms (one pass, fed by its own drive), harmonic by harmonic. Frequencies from the highest down, until
/// what ngspice has to do passes some seconds.
struct BoardsInTime {
  std::string key;  ///< of that form (tracked::); empty: no board
  std::vector<BoardInTime> at;
  std::string missing;  ///< why not, or not everywhere
};
BoardsInTime track_board_in_time(const Project& project, const Design& design,
                                 const std::vector<TrackedCandidate>& candidates);

}  // namespace bodesmith::project
