#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fpaa/plan/plan.hpp"

namespace bodesmith::fpaa {

/// What a CAM takes of a board.
struct PlaceNeed {
  Resources resources;
  int group =
      0;  ///< CAMs of a group stay on one chip where they can; groups are placed in the order of their numbers
  /// Of the master clock: those of a chip are at most six, and come from one system divisor. Absent: not looked at.
  std::optional<std::int64_t> divisor = {};
};
struct Place {
  int chip = 1;
  int cab = 1;
};
/// Chips and CABs: a CAM goes into the fullest CAB of a chip that has room (none straddles CABs), a group whole onto the present chip, the
/// next that has room for it, or one before; only one that fits on none is spread. Refused with how many CAMs fit.
Outcome<std::vector<Place>> place(const std::vector<PlaceNeed>& cams, const Board& board);

/// Signals that enter and leave a chip, by name, each through one I/O cell ("in1", "in2", … and "out1", … in this order).
struct ChipSignals {
  std::vector<std::string> in;
  std::vector<std::string> out;
  int pins() const { return static_cast<int>(in.size() + out.size()); }
};
/// Of each chip of the board; `leaving`: the CAMs whose output leaves the board.
std::vector<ChipSignals> chip_signals(const std::vector<WiredCam>& cams,
                                      const std::vector<std::string>& leaving, const Board& board);

/// Chips, clocks, CAMs and every wire. What comes from outside enters by a pin of each chip that reads it; `wired_on`: by one pin of the
/// board, from which the others are wired. Clocks come from one system divisor where one makes them all, else from two.
Plan assembled(const std::vector<WiredCam>& cams, const std::vector<std::string>& leaving, const Board& board,
               bool wired_on);

}  // namespace bodesmith::fpaa
