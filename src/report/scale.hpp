#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "report/plot.hpp"

namespace bodesmith::report {

/// Round tick positions that cover [from, to] (linear), about `count` of them: steps of 1, 2 or 5 times a power of ten.
std::vector<double> linear_ticks(double from, double to, int count);
/// Decades in [from, to]; of fewer than four also 2 and 5 times them.
std::vector<double> logarithmic_ticks(double from, double to);
/// 2 ... 9 times each decade within [from, to]: the fine lines between the ticks.
std::vector<double> logarithmic_subdivisions(double from, double to);

/// 0.25, 100, 1e5, 2.5e-4.
std::string tick_text(double value);
/// The same with prefixes, for axes of hertz: 0.25, 100, 20k, 1M.
std::string prefixed_tick_text(double value);

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
