#pragma once

#include <vector>

#include "base/units.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::fpaa {

/// Zeros of less damping count as if they had this one, when an error is stated relative to the response.
inline constexpr double kLeastZeroDamping = 0.02;

/// What an error at w is relative to: |H(jw)|, but for zeros on the axis or close to it, where nothing could be
/// relative to a response of 0: there the response that the sections had if the zero were damped by
/// kLeastZeroDamping,
///   |H(jw)| prod max(1, 0.02 |z| / |jw - z|)
/// (within 2 % of a notch; |H| itself everywhere else).
double error_reference(const Sections& sections, RadPerSecond w);

/// True where the reference is not |H| itself.
bool is_near_zero(const Sections& sections, RadPerSecond w);

/// The band in which a board is judged when none is asked for: all corners, and the band that the sections
/// state. Corners far outside a stated band (30 times below its lower end, or above 100 kHz: a fit that uses
/// them as zeros at 0 or at infinity) do not widen it.
Band judged_band(const Sections& sections);

/// Frequencies about resonances and notches that a grid of the band would step over: some widths around each.
std::vector<Hertz> about_sharp_roots(const Sections& sections, Band band);

}  // namespace bodesmith::fpaa
