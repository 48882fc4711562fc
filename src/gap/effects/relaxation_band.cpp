#include "gap/effects/relaxation_band.hpp"

#include <cmath>
#include <numbers>

namespace bodesmith::gap {
namespace {

/// Middle corner frequencies over the drive's middle one: above the first it is the band's, below the second it is
/// slower.
constexpr double kInBand = 0.35;
constexpr double kBelowBand = 0.2;

double corner_over_band(double middle_s, const Scene& scene) {
  return 1.0 / (2.0 * std::numbers::pi * middle_s * std::sqrt(scene.low_hz * scene.band_hz));
}

}  // namespace

bool lies_in_driven_band(double middle_s, const Scene& scene) {
  return !scene.frequency_only && middle_s > 0.0 && corner_over_band(middle_s, scene) > kInBand;
}

bool lies_below_driven_band(double middle_s, const Scene& scene) {
  return !scene.frequency_only && middle_s > 0.0 && corner_over_band(middle_s, scene) < kBelowBand;
}

}  // namespace bodesmith::gap
