#pragma once

#include <string>

#include "lti/sections.hpp"

namespace bodesmith::cli {

/// The sections without their delay, which no circuit of poles and zeros makes; says so in a note.
Sections rational_part(Sections sections, const std::string& file);

}  // namespace bodesmith::cli
