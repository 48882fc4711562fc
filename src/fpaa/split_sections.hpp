#pragma once

#include <vector>

#include "fpaa/cams/cam.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// Sections as the tasks of CAMs, in signal order, and the gain that stays over:
///   H(s) = sign * exp(log_gain) * prod of the tasks' factors.
struct TaskChain {
  std::vector<CamTaskPtr> tasks;
  double log_gain = 0.0;
  bool negative = false;
};

/// Each section whose roots are real becomes pieces of one pole, each zero with the pole that is nearest in
/// ratio (the pairing whose widest pair is narrowest); a section with complex roots stays whole. Each piece
/// goes to the first CAM of cam_registry() that offers to make it. Refused, naming the section and what would
/// make it work, when there is none.
Outcome<TaskChain> split_into_tasks(const Sections& sections);

}  // namespace bodesmith::fpaa
