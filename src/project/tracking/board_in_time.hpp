#pragma once

#include <string>
#include <vector>

#include "project/tracking/tracked_designs.hpp"

namespace bodesmith::project {

/// A board in time, at one frequency, by ngspice and by charge conservation (fpaa::BoardRun).
struct BoardInTime {
  Hertz frequency{0.0};
  double followed_s = 0.0;          ///< behind what the start leaves
  double rms_percent = 0.0;         ///< what the stage makes of ngspice's drive, the best pure delay removed
  double difference_percent = 0.0;  ///< rms between both drives, of the stroke
};

/// Frequencies from the highest down, until what ngspice has to do passes some seconds.
struct BoardsInTime {
  std::string key;  ///< of what was followed (TrackedDesign::key); empty: nothing
  std::vector<BoardInTime> at;
  std::string missing;  ///< why not, or not everywhere
  std::string apart;    ///< what else than errors is between closed form and ngspice; empty: nothing
};
/// A board as compensator, the better of its two forms (one pass, fed by its own drive) harmonic by harmonic: the drive that ngspice
/// makes with its board.sub and an ideal generator, and what charge conservation makes of what ngspice's board read.
BoardsInTime track_board_in_time(const Project& project, const Design& design,
                                 const std::vector<TrackedCandidate>& candidates);
/// The controller on the board that tracks best of those in `tracked`: fpaa::controller_netlist in ngspice, and the same by charge
/// conservation, over one repeat each.
BoardsInTime track_board_controller_in_time(const Project& project,
                                            const std::vector<TrackedDesign>& tracked);

}  // namespace bodesmith::project
