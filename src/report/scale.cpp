#include "report/scale.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::report {

Range data_range(const Plot& plot, std::vector<double> Series::*coordinate, bool logarithmic) {
  Range out{INFINITY, -INFINITY};
  for (const Series& series : plot.series) {
    for (const double value : series.*coordinate) {
      if (!std::isfinite(value) || (logarithmic && value <= 0.0)) continue;
      out.low = std::min(out.low, value);
      out.high = std::max(out.high, value);
    }
  }
  if (out.low <= out.high) return out;
  return logarithmic ? Range{1.0, 10.0} : Range{0.0, 1.0};
}

Range with_margin(Range range, bool logarithmic) {
  if (logarithmic)
    return {std::pow(10.0, std::floor(std::log10(range.low))),
            std::pow(10.0, std::ceil(std::log10(range.high)))};
  const double margin =
      range.high > range.low ? 0.06 * (range.high - range.low) : std::max(1e-12, 0.1 * std::abs(range.high));
  return {range.low - margin, range.high + margin};
}

Scale make_scale(const Axis& axis, Range range, double pixel_from, double pixel_to) {
  if (axis.fixed) range = {axis.from, axis.to};
  if (!(range.high > range.low)) range.high = axis.logarithmic ? range.low * 10.0 : range.low + 1.0;
  return {axis.logarithmic, range.low, range.high, pixel_from, pixel_to};
}

}  // namespace bodesmith::report
