#pragma once

#include <string>
#include <vector>

#include "project/budget.hpp"
#include "project/design.hpp"

namespace bodesmith::project {

/// What an alternative becomes when it is built: for a reader who would choose another one than the run did.
struct AlternativeStudy {
  Design
      design;  ///< the run's with this alternative chosen, and its own plan and circuit where they can be made
  Budget budget;
  std::vector<std::string> refused;  ///< why board or parts cannot make it
};

/// One for every alternative, in their order. The one that the run builds is not made anew.
std::vector<AlternativeStudy> study_alternatives(const Project& project, const Design& design,
                                                 AlternativeHardware& hardware);

}  // namespace bodesmith::project
