#pragma once

#include <cmath>
#include <vector>

#include "report/plot.hpp"
#include "report/ticks.hpp"

namespace bodesmith::report {

struct Range {
  double low;
  double high;
};

/// Data range of one coordinate (&Series::x, &Series::y) over all series; a default one when there is nothing to show.
Range data_range(const Plot& plot, std::vector<double> Series::*coordinate, bool logarithmic);

/// A vertical axis stands a little off its data: whole decades, or a margin.
Range with_margin(Range range, bool logarithmic);

/// An axis with its final range, and the map from values to pixels.
struct Scale {
  bool logarithmic;
  double from;
  double to;
  double pixel_from;
  double pixel_to;

  double pixel(double value) const {
    const double t =
        logarithmic ? std::log(value / from) / std::log(to / from) : (value - from) / (to - from);
    return pixel_from + t * (pixel_to - pixel_from);
  }
  bool drawable(double value) const { return std::isfinite(value) && (!logarithmic || value > 0.0); }
  /// About `count`, at least four.
  std::vector<double> ticks(int count) const;
};

/// The axis' own range when it is fixed, otherwise the given one.
Scale make_scale(const Axis& axis, Range range, double pixel_from, double pixel_to);

}  // namespace bodesmith::report
