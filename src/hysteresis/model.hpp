#pragma once

#include <string>

#include "hysteresis/parameters.hpp"

namespace bodesmith::hysteresis {

/// A model as it stands in model.toml: the type's name and the values of its parameters.
struct Model {
  std::string type;
  Parameters parameters;
};

}  // namespace bodesmith::hysteresis
