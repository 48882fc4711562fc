#pragma once

#include <vector>

#include "base/outcome.hpp"
#include "fpaa/device/board.hpp"

namespace bodesmith::fpaa {

struct Place {
  int chip = 1;
  int cab = 1;
};

/// Puts CAMs on chips and CABs in signal order: a CAM goes into the first CAB of the present chip that has
/// room (no CAM straddles CABs), and a new chip is begun when none has, so that the path crosses from chip to
/// chip only forwards. Refused with how many CAMs fit.
Outcome<std::vector<Place>> place_in_order(const std::vector<Resources>& cams, const Board& board);

/// The same for CAMs in groups (`groups[i]` of CAM i, placed in the order of their numbers): a group goes
/// whole onto the present chip, or the next one; only one that fills more than a chip is spread.
Outcome<std::vector<Place>> place_groups(const std::vector<Resources>& cams, const std::vector<int>& groups,
                                         const Board& board);

}  // namespace bodesmith::fpaa
