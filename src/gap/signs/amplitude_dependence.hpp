#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// How a response changes from a small drive to a large one: what no linear effect does.
enum class AmplitudeClass {
  softening_stiffness,  ///< the peak moves down
  hardening_stiffness,  ///< the peak moves up
  rising_damping,       ///< the peak falls and what is next to it does not
  falling_damping,
  rising_gain,
  falling_gain,
  falling_gain_at_top,  ///< at high frequencies only
};
/// As in diagnosis.json.
std::string to_string(AmplitudeClass kind);
/// Effects of the catalogue that do this.
std::vector<std::string> suspects_of(AmplitudeClass kind);

struct AmplitudeDependence {
  AmplitudeClass kind = AmplitudeClass::falling_gain;
  double least_drive_v = 0.0;
  double largest_drive_v = 0.0;
  double change = 0.0;       ///< rms of ln(H at the largest drive/H at the least), noise taken off
  double times_noise = 0.0;  ///< over the noise of that logarithm; infinite where there is none
  double strength = 0.0;     ///< Sign::strength
  /// Of the highest peak that both have, Hz.
  std::optional<double> peak_at_least_hz;
  std::optional<double> peak_at_largest_hz;
};

/// Whether responses that were taken at several drives (FrequencyRecord::drive_v, the median of each record) differ by
/// more than their noise. Noise of separate points is not alike from one to the next; a change is. Nothing without two
/// drives that are a twentieth apart.
std::optional<AmplitudeDependence> amplitude_dependence(const Experiments& experiments);

/// Those of the least drive, where a system is nearest to a linear one; all, where no drive is known.
Experiments of_least_drive(const Experiments& experiments);

/// For a person.
std::string to_text(const AmplitudeDependence& dependence);

}  // namespace bodesmith::gap
