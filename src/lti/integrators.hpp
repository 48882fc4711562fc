#pragma once

#include "lti/sections.hpp"

namespace bodesmith {

/// A pole at the origin, all others in the left half plane.
bool integrates(const Section& section);
/// Some section has a pole at the origin.
bool integrates(const Sections& sections);

}  // namespace bodesmith
