#pragma once

#include "base/units.hpp"
#include "lti/sections.hpp"

namespace bodesmith::filters {

/// Peak (or dip, gain below 0 dB) at w0:
///   H(s) = (s^2 + (A/Q) w0 s + w0^2)/(s^2 + w0 s/(A Q) + w0^2), A^2 the gain at w0
/// (R. Bristow-Johnson's form, symmetric in boost and cut).
Sections peaking(Hertz centre, double gain_db, double quality);

/// First-order shelf: gain at one end of the band, 1 at the other, half of it in dB at the corner.
///   low:  H = (s + sqrt(g) w)/(s + w/sqrt(g)), high: its mirror image.
Sections low_shelf(Hertz corner, double gain_db);
Sections high_shelf(Hertz corner, double gain_db);

/// All-pass that delays: H(s) = theta_N(-s T/2)/theta_N(s T/2), theta_N the reverse Bessel polynomial: the diagonal Padé
/// approximant of exp(-s T), flat group delay T at low frequencies.
Sections delay_allpass(double delay_s, int order);

}  // namespace bodesmith::filters
