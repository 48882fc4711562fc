#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "base/units.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith {

/// Where the compensator stands in the disturbance generator.
enum class DrivenPath {
  whole,       ///< behind the branch switch: it filters the whole periodic disturbance
  ascending,   ///< in the ascending polynomial's own path, before the switch; only the rising half counts
  descending,  ///< the same for the descending one
};
std::string_view to_string(DrivenPath path);

/// The disturbance polynomials under a triangle x(t), 0 to 1 in the first half of the period and back in the
/// second, without gain tables: exact Fourier coefficients U_k = integral_0^1 u e^(-2 pi j k phase) d phase.
struct TriangleSeries {
  std::vector<Complex> coefficient;  ///< k = 0 ... harmonics; U_(-k) is the conjugate
  Disturbance disturbance;
  DrivenPath path = DrivenPath::whole;

  /// u at a phase in [0, 1).
  double value(double phase) const;
};

/// What enters a compensator in that path: the switched disturbance, or one branch's polynomial on both
/// slopes.
TriangleSeries triangle_series(const Disturbance& disturbance, DrivenPath path, std::size_t harmonics);

/// G(jw) of anything linear: a cascade, sections, a realised chain.
using FrequencyResponse = std::function<Complex(RadPerSecond)>;
/// Harmonics of one operating frequency are harmonics of others, too: each is worked out once, whichever thread asks.
FrequencyResponse remembered(FrequencyResponse response);

struct WaveformErrorOptions {
  DrivenPath path = DrivenPath::whole;
  /// Of the operating frequency; what lies above is added in closed form with G(infinity).
  int harmonics = 4096;
};

/// The periodic steady state at one operating frequency, triangle x(t) from 0 to 1 and back.
struct WaveformErrorPoint {
  Hertz frequency;
  double rms_percent = 0.0;   ///< of the range of x (= 1), over a whole period (disturbance paper, eq. 8)
  double peak_percent = 0.0;  ///< largest |error| over the period
};

struct WaveformError {
  std::vector<WaveformErrorPoint> points;
  double rms_percent = 0.0;    ///< root mean square over the frequencies
  double worst_percent = 0.0;  ///< largest rms_percent
};

/// Error of the compensating waveform that a linear filter G makes from the disturbance polynomials:
///   e(t) = (g * d)(t) - K_branch(f) d_branch(x(t)),   d without gain tables, K the rate gains,
/// which is what remains in the displacement of a stage that has exactly this disturbance. Unlike a magnitude
/// fit it counts G's phase and its values at the harmonics and at 0 Hz. The Fourier coefficients of the
/// piecewise polynomials are exact; the energy above `harmonics` is exact for a G that has reached
/// G(infinity) there.
WaveformError waveform_error(const FrequencyResponse& g, const Disturbance& disturbance,
                             const std::vector<Hertz>& operating, const WaveformErrorOptions& options = {});

/// The frequencies of the disturbance's rate table.
std::vector<Hertz> operating_frequencies(const Disturbance& disturbance);

}  // namespace bodesmith
