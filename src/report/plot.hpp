#pragma once

#include <string>
#include <vector>

namespace bodesmith::report {

/// One curve (or set of marks) of a plot. x and y of equal length; a point that is not finite breaks the
/// line.
struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  enum class Style { line, dashed, marks } style = Style::line;
  int color = -1;      ///< index into the palette; -1: the series' own place in the plot
  double width = 1.8;  ///< stroke width in pixels
  bool shown = true;   ///< a live plot begins with it; the still one always has it
};

struct Axis {
  std::string label;
  bool logarithmic = false;
  bool fixed = false;  ///< use from/to as given; otherwise they follow from the data
  double from = 0.0;
  double to = 1.0;
};

/// A diagram with axes, grid, legend.
struct Plot {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Series> series;
  int width = 900;  ///< of a page's column
  int height = 340;
};

/// The plot as one `svg` element that stands on its own (white ground, no scripts, no outside fonts).
std::string to_svg(const Plot& plot);

/// Plots of equal width below one another in one `svg`, e.g. magnitude and phase.
std::string stack_svg(const std::vector<Plot>& plots);

/// Magnitude (dB) and phase (degrees) over log frequency, one below the other; the caller adds the series.
struct BodePlot {
  Plot magnitude;
  Plot phase;
  BodePlot();
  std::vector<Plot> plots() const { return {magnitude, phase}; }
};

}  // namespace bodesmith::report
