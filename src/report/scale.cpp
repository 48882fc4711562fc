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

std::vector<double> Scale::ticks(int count) const {
  constexpr std::size_t kFewest = 4;
  std::vector<double> out = logarithmic ? logarithmic_ticks(from, to) : linear_ticks(from, to, count);
  if (logarithmic && out.size() < kFewest) {
    // Few decades: 2 and 5 times them too.
    out.clear();
    for (double decade = std::pow(10.0, std::floor(std::log10(from))); decade <= to; decade *= 10.0) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double value = factor * decade;
        if (value >= from * (1.0 - 1e-9) && value <= to * (1.0 + 1e-9)) out.push_back(value);
      }
    }
  }
  // Within a decade, or where steps of 1, 2 and 5 fall badly.
  for (int more = logarithmic ? count : count + 1; out.size() < kFewest && more < 4 * count; ++more)
    out = linear_ticks(from, to, more);
  return out;
}

Scale make_scale(const Axis& axis, Range range, double pixel_from, double pixel_to) {
  if (axis.fixed) range = {axis.from, axis.to};
  if (!(range.high > range.low)) range.high = axis.logarithmic ? range.low * 10.0 : range.low + 1.0;
  return {axis.logarithmic, range.low, range.high, pixel_from, pixel_to};
}

}  // namespace bodesmith::report
