#pragma once

#include "project/design/target_fit.hpp"

namespace bodesmith::project {

/// A stage's design as `run` makes it, one step after the other.
inline Design make_design(const Project& project) {
  Design out = fit_stage(project);
  AlternativeHardware hardware(project, out.fit, out.alternatives);
  choose_alternative(project, hardware, out);
  add_controller(make_analog_controller(project), out);
  return out;
}

}  // namespace bodesmith::project
