#pragma once

#include "approximate/approximation_error.hpp"
#include "lti/cascade.hpp"
#include "lti/sections.hpp"

namespace bodesmith {

/// What leaving out near-cancelling pairs saves and costs.
struct MergedSections {
  Sections sections;
  int pairs_left_out = 0;
  ApproximationError error;  ///< against the cascade, afterwards
};

/// Leaves out real pole-zero pairs, the closest in log frequency first, while the largest magnitude error
/// against the cascade over all frequencies stays within `limit_db`. A pair (s - z)/(s - p) is replaced by
/// its gain half way, sqrt(z/p), and after each the whole gain is set so that the largest errors up and down
/// are equal. What cannot be left out stays as it is; sections are made anew (make_sections).
MergedSections merge_sections(const Sections& sections, const Cascade& cascade, double limit_db);

}  // namespace bodesmith
