#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fit/cascade/cascade_fit.hpp"
#include "fit/direct/direct_fit.hpp"

namespace bodesmith {

/// Orders above this cannot be built: a term needs as many poles, and the last digits of a gain decide about them.
inline constexpr double kLargestUsableOrder = 20.0;
/// Where the disturbance paper bounds orders that cannot be built (its Fig. 10).
inline constexpr double kChartBound = 5.0;

/// More points than this would make more bands than anybody builds.
inline constexpr std::size_t kMostPointsToInterpolate = 40;

/// Why no hardware can be made of this cascade ("29 bands with orders up to 3.7e4"); nothing when it can.
std::optional<std::string> why_unusable(const CascadeFit& fit);

/// A cascade by the flow chart of the disturbance paper (Fig. 4), and what was done, a sentence a step.
struct ChartedFit {
  CascadeFit fit;
  std::vector<std::string> steps;  ///< empty: every point is interpolated
};
/// Interpolation (eq. 18); where orders are beyond use, least squares with |beta| <= 5 (eq. 19); then the band that ends at
/// the point with the largest error is split in two, as long as that takes a tenth off that error, four times at most. What is
/// left is data of the fit. With bounds, corners or the fewest bands asked for: that, and no chart.
ChartedFit fit_by_chart(const BodePoints& points, const CascadeFitOptions& options);

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
