#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "lti/sections.hpp"

namespace bodesmith::exchange {

/// H(z) = (b0 + b1/z + b2/z^2)/(1 + a1/z + a2/z^2)
struct Biquad {
  double b0 = 1.0;
  double b1 = 0.0;
  double b2 = 0.0;
  double a1 = 0.0;
  double a2 = 0.0;
};

enum class Discretisation {
  tustin,   ///< s = K (z - 1)/(z + 1), K = w/tan(w T/2): exact at w
  matched,  ///< roots z = exp(s T), zeros at infinity to -1, gain met at one frequency
};
std::string_view to_string(Discretisation method);

struct DiscretiseOptions {
  double sample_hz = 0.0;
  Discretisation method = Discretisation::tustin;
  /// The frequency at which every section is exact (tustin) or has its gain (matched). Without it each section has its
  /// own: tustin the corner of its poles, matched DC where the section has a gain there.
  std::optional<Hertz> prewarp;
  bool single_precision = false;  ///< coefficients rounded to float
  int fixed_bits = 0;             ///< coefficients rounded to so many bits, two's complement; 0: not
};

/// A chain of biquads, and how far it is from the sections.
struct DigitalFilter {
  double gain = 1.0;
  std::vector<Biquad> biquads;
  double sample_hz = 0.0;
  Discretisation method = Discretisation::tustin;
  int fraction_bits = 0;  ///< of fixed_bits: behind the point, as many as the greatest coefficient leaves

  struct Error : ResponseDifference {
    /// From a tenth of the lowest corner to ten times the highest, at most 0.45 of the sampling rate; where the sections have
    /// kJudgedFloor of their largest magnitude there.
    Band band;
    std::string steep;  ///< of a response with flanks: how errors are told there (lti/steep_flanks.hpp)
  } error;

  Complex response(Hertz f) const;
};

/// The sections' delay is left out, of the error too. InputError for a sampling rate that is not above twice the lowest
/// corner, and for poles that rounding moved out of the unit circle.
DigitalFilter discretise(const Sections& sections, const DiscretiseOptions& options);

}  // namespace bodesmith::exchange
