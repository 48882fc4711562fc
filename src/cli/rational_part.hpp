#pragma once

#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "lti/sections.hpp"

namespace bodesmith::cli {

/// The sections without their delay, which no circuit of poles and zeros makes; says so in a note.
Sections rational_part(Sections sections, const std::string& file);

/// Several sections.json as one: what is built has them one after the other.
Sections read_rational_series(const std::vector<std::string>& files, Provenance& from);

}  // namespace bodesmith::cli
