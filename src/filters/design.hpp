#pragma once

#include "filters/family.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::filters {

enum class Kind { lowpass, highpass, bandpass, bandstop };
const char* to_string(Kind kind);

/// Where the prototype's corner goes. Low and high pass: corner.from. Band pass and band stop: both.
struct Placing {
  Kind kind = Kind::lowpass;
  Band corner;
};

/// The prototype at its place,
///   low pass s -> s/w_c, high pass s -> w_c/s, band pass s -> (s^2 + w_0^2)/(B s), band stop s -> B s/(s^2 + w_0^2),
///   w_0^2 = w_1 w_2, B = w_2 - w_1,
/// as sections of one pole or a conjugate pair. Throws InputError for corners that are not above 0 or not rising, or so
/// far from 1 Hz that the gain leaves the range of numbers.
Sections place(const Prototype& prototype, const Placing& placing);

/// Attenuation limits: at most `ripple_db` over the pass band, at least `stop_db` over the stop band.
struct Mask {
  Kind kind = Kind::lowpass;
  Band pass;  ///< low and high pass: only `from`
  Band stop;
  double ripple_db = 0.5;
  double stop_db = 60.0;
};

/// The least order that keeps a mask.
struct MaskedDesign {
  int order = 0;
  Prototype prototype;
  Placing placing;
  double ripple_db = 0.0;  ///< attenuation at the edge of the pass band
  double stop_db = 0.0;    ///< at the (nearer) edge of the stop band
};
/// Throws InputError for an impossible mask, DesignError when the family's highest order does not keep it.
MaskedDesign least_order(const Family& family, const Mask& mask);

}  // namespace bodesmith::filters
