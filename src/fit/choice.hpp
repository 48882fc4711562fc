#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "fit/cascade_fit.hpp"
#include "fit/direct_fit.hpp"

namespace bodesmith {

/// Orders above this cannot be built: a term needs as many poles, and the last digits of a gain decide about them. A dozen
/// points are each meant; there only what is far beyond is refused.
inline constexpr double kLargestUsableOrder = 20.0;
inline constexpr double kLargestUsableOrderOfFewPoints = 200.0;
inline constexpr std::size_t kFewPoints = 12;

/// More points than this would make more bands than anybody builds.
inline constexpr std::size_t kMostPointsToInterpolate = 40;

/// Why no hardware can be made of this cascade ("29 bands with orders up to 3.7e4"); nothing when it can.
std::optional<std::string> why_unusable(const CascadeFit& fit);

/// The fewest poles that the cascade's terms can be approximated with.
int least_poles(const CascadeFit& fit);

/// Points that are too many, or too steep, to be interpolated: a cascade of the fewest bands, or sections directly.
struct FitChoice {
  std::optional<CascadeFit> cascade;  ///< this
  std::optional<DirectFit> sections;  ///< or this
  std::string why;
};

/// Within `limit_db` of every point where one of the two can: the one that needs fewer poles.
FitChoice choose_fit(const BodePoints& points, const CascadeFitOptions& cascade,
                     const DirectFitOptions& direct, double limit_db);

}  // namespace bodesmith
