#pragma once

#include "base/units.hpp"
#include "fpaa/cams/cam_values.hpp"

namespace bodesmith::fpaa {

/// CAM FilterBiquad: the two integrators of biquad_stage.hpp with one input: C1 (option Low Pass), Cp (Band Pass) or
/// Cpp (High Pass). CA and CB are each split over two banks (up to 510 units). The low-pass form is derived from vendor code;
/// band and high pass are the standard circuit that has the vendor's gains (assumed). The pole-and-zero form is not publicly known.
///
/// What its dialog asks for.
struct BiquadSpec {
  Hertz corner;
  double quality = 1.0;
  double gain = 1.0;  ///< at DC (low pass), at the centre (band pass), at high frequency (high pass)

  CamValues values() const;
  static BiquadSpec from(const CamValues& values);
};

}  // namespace bodesmith::fpaa
