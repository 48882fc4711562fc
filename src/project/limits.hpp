#pragma once

#include <optional>
#include <string>
#include <vector>

#include "project/design.hpp"
#include "project/project.hpp"

namespace bodesmith::project {

/// One line of [limits]: what was asked and what came out.
struct LimitCheck {
  std::string name;  ///< key in project.toml
  double limit = 0.0;
  double got = 0.0;
  bool met() const { return got <= limit; }
};

std::vector<LimitCheck> check_limits(const Project& project, const Design& design);

}  // namespace bodesmith::project
