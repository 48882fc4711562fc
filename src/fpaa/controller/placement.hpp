#pragma once

#include <vector>

#include "base/error.hpp"
#include "fpaa/device/board.hpp"

namespace bodesmith::fpaa {

struct Place {
  int chip = 1;
  int cab = 1;
};

/// Puts CAMs in groups (`groups[i]` of CAM i, placed in the order of their numbers) on chips and CABs: a CAM goes into
/// the first CAB of the present chip that has room (none straddles CABs), a group whole onto the present chip, or the
/// next one; only one that fills more than a chip is spread. Refused with how many CAMs fit.
Outcome<std::vector<Place>> place_groups(const std::vector<Resources>& cams, const std::vector<int>& groups,
                                         const Board& board);

}  // namespace bodesmith::fpaa
