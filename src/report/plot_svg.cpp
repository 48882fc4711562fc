#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "report/scale.hpp"
#include "report/script_data.hpp"
#include "report/svg.hpp"

namespace bodesmith::report {

BodePlot::BodePlot() {
  magnitude.title = "Magnitude";
  magnitude.x = {"frequency, Hz", true};
  magnitude.y = {"dB"};
  phase.title = "Phase";
  phase.x = magnitude.x;
  phase.y = {"degrees"};
}

// SVG is drawn here element by element, next to the geometry it depends on; nothing of it is text for a template.

namespace {

// Pixels around the diagram.
constexpr int kLeft = 72;
constexpr int kRight = 18;
constexpr int kTop = 34;
constexpr int kBottom = 48;
constexpr int kLegendRow = 18;

/// The diagram's frame in pixels, and its two scales.
struct Frame {
  double right;
  double bottom;
  Scale x;
  Scale y;

  bool drawable(const Series& series, std::size_t i) const {
    return x.drawable(series.x[i]) && y.drawable(series.y[i]);
  }
};

Frame make_frame(const Plot& plot) {
  const double right = plot.width - kRight;
  const double bottom = plot.height - kBottom;
  const Range x = data_range(plot, &Series::x, plot.x.logarithmic);
  const Range y = with_margin(data_range(plot, &Series::y, plot.y.logarithmic), plot.y.logarithmic);
  return {right, bottom, make_scale(plot.x, x, kLeft, right), make_scale(plot.y, y, bottom, kTop)};
}

/// Names set in rows below the diagram.
struct LegendLayout {
  struct Entry {
    std::size_t series;
    int column_x;
    int row;
  };
  std::vector<Entry> entries;
  int rows = 0;
};

LegendLayout lay_out_legend(const Plot& plot) {
  LegendLayout legend;
  int x = kLeft;
  int row = 0;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    if (plot.series[i].name.empty()) continue;
    const int needed = 34 + static_cast<int>(6.6 * static_cast<double>(plot.series[i].name.size()));
    if (x > kLeft && x + needed > plot.width - kRight) {
      x = kLeft;
      ++row;
    }
    legend.entries.push_back({i, x, row});
    x += needed + 10;
  }
  legend.rows = legend.entries.empty() ? 0 : row + 1;
  return legend;
}

int total_height(const Plot& plot) {
  return plot.height + kLegendRow * lay_out_legend(plot).rows;
}

std::string colour_of(const Plot& plot, std::size_t series) {
  const int chosen = plot.series[series].color;
  return palette_colour(chosen >= 0 ? chosen : static_cast<int>(series));
}

/// Colours come again after eight series, with another dash.
std::string dash_attribute(const Plot& plot, std::size_t index) {
  static constexpr std::array<const char*, 3> kDashes = {"", " stroke-dasharray=\"2 3\"",
                                                         " stroke-dasharray=\"9 3 2 3\""};
  const Series& series = plot.series[index];
  if (series.style == Series::Style::dashed) return " stroke-dasharray=\"6 4\"";
  const std::size_t colour = series.color >= 0 ? static_cast<std::size_t>(series.color) : index;
  return kDashes[colour / kPaletteColours % kDashes.size()];
}

/// Collects the d attribute of a path: a gap in the data lifts the pen.
class PathText {
 public:
  PathText(const Series& series, const Frame& frame) : series_(series), frame_(frame) {}

  void lift() { pen_down_ = false; }
  void point(std::size_t i) {
    fmt::format_to(std::back_inserter(text_), "{}{:.2f} {:.2f}", pen_down_ ? "L" : "M",
                   frame_.x.pixel(series_.x[i]), frame_.y.pixel(series_.y[i]));
    pen_down_ = true;
  }
  const std::string& text() const { return text_; }

 private:
  const Series& series_;
  const Frame& frame_;
  std::string text_;
  bool pen_down_ = false;
};

std::string path_of(const Series& series, const Frame& frame) {
  PathText path(series, frame);
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i)
    frame.drawable(series, i) ? path.point(i) : path.lift();
  return path.text();
}

void draw_series(const Plot& plot, std::size_t index, const Frame& frame, std::string& out) {
  // A loop of a million samples would be a drawing of many megabytes.
  const Series series = thinned(plot.series[index], kMostLivePoints, plot.x.logarithmic);
  const std::string colour = colour_of(plot, index);
  auto sink = std::back_inserter(out);
  if (series.style != Series::Style::marks) {
    fmt::format_to(
        sink, "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}/>",
        path_of(series, frame), colour, series.width, dash_attribute(plot, index));
    return;
  }
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    if (!frame.drawable(series, i)) continue;
    fmt::format_to(
        sink,
        "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"3.6\" fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.8\"/>",
        frame.x.pixel(series.x[i]), frame.y.pixel(series.y[i]), colour);
  }
}

std::string tick_label(const Axis& axis, double value) {
  return axis.label.ends_with("Hz") ? prefixed_tick_text(value) : tick_text(value);
}

void draw_grid(const Plot& plot, const Frame& frame, std::string& out) {
  auto sink = std::back_inserter(out);
  const auto vertical = [&](double value, const char* colour) {
    fmt::format_to(sink, "<path d=\"M{0:.2f} {1}V{2}\" stroke=\"{3}\"/>", frame.x.pixel(value), kTop,
                   frame.bottom, colour);
  };
  if (frame.x.logarithmic) {
    for (const double value : logarithmic_subdivisions(frame.x.from, frame.x.to)) vertical(value, "#f0f1f3");
  }
  for (const double value : frame.x.ticks(8)) {
    vertical(value, "#dcdfe4");
    fmt::format_to(sink, "<text x=\"{:.2f}\" y=\"{}\" text-anchor=\"middle\">{}</text>", frame.x.pixel(value),
                   frame.bottom + 17, tick_label(plot.x, value));
  }
  for (const double value : frame.y.ticks(std::max(3, (plot.height - kTop - kBottom) / 45))) {
    const double y = frame.y.pixel(value);
    fmt::format_to(sink, "<path d=\"M{} {:.2f}H{}\" stroke=\"#dcdfe4\"/>", kLeft, y, frame.right);
    fmt::format_to(sink, "<text x=\"{}\" y=\"{:.2f}\" text-anchor=\"end\">{}</text>", kLeft - 7, y + 4,
                   tick_label(plot.y, value));
  }
}

/// The border over the curves, and what the axes are.
void draw_border(const Plot& plot, const Frame& frame, std::string& out) {
  auto sink = std::back_inserter(out);
  fmt::format_to(sink,
                 "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#8a919c\"/>",
                 kLeft, kTop, frame.right - kLeft, frame.bottom - kTop);
  fmt::format_to(sink, "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\" fill=\"#1b1f24\">{}</text>",
                 (kLeft + frame.right) / 2, plot.height - 12, escape_xml(plot.x.label));
  fmt::format_to(sink,
                 "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\" "
                 "fill=\"#1b1f24\">{}</text>",
                 (kTop + frame.bottom) / 2, escape_xml(plot.y.label));
}

void draw_legend(const Plot& plot, std::string& out) {
  auto sink = std::back_inserter(out);
  for (const LegendLayout::Entry& entry : lay_out_legend(plot).entries) {
    const Series& series = plot.series[entry.series];
    const std::string colour = colour_of(plot, entry.series);
    const int y = plot.height + entry.row * kLegendRow + 4;
    if (series.style == Series::Style::marks) {
      fmt::format_to(
          sink, "<circle cx=\"{}\" cy=\"{}\" r=\"3.6\" fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.8\"/>",
          entry.column_x + 12, y - 4, colour);
    } else {
      fmt::format_to(sink, "<path d=\"M{} {}h24\" stroke=\"{}\" stroke-width=\"{}\"{}/>", entry.column_x,
                     y - 4, colour, series.width, dash_attribute(plot, entry.series));
    }
    fmt::format_to(sink, "<text x=\"{}\" y=\"{}\" fill=\"#1b1f24\">{}</text>", entry.column_x + 30, y,
                   escape_xml(series.name));
  }
}

/// The plot's elements without the <svg> around them, moved down by `offset`.
std::string plot_group(const Plot& plot, int offset, std::size_t clip_number) {
  const Frame frame = make_frame(plot);
  std::string out;
  auto sink = std::back_inserter(out);
  fmt::format_to(sink, "<g transform=\"translate(0 {})\">", offset);
  fmt::format_to(sink,
                 "<text x=\"{}\" y=\"20\" font-size=\"14\" font-weight=\"600\" fill=\"#1b1f24\">{}</text>",
                 kLeft, escape_xml(plot.title));
  draw_grid(plot, frame, out);
  fmt::format_to(
      sink,
      "<clipPath id=\"plot-{0}-{1}\"><rect x=\"{2}\" y=\"{3}\" width=\"{4}\" height=\"{5}\"/></clipPath>",
      clip_number, offset, kLeft, kTop, frame.right - kLeft, frame.bottom - kTop);
  fmt::format_to(sink, "<g clip-path=\"url(#plot-{}-{})\">", clip_number, offset);
  for (std::size_t i = 0; i < plot.series.size(); ++i) draw_series(plot, i, frame, out);
  out += "</g>";
  draw_border(plot, frame, out);
  draw_legend(plot, out);
  out += "</g>";
  return out;
}

}  // namespace

std::string to_svg(const Plot& plot) {
  return stack_svg({plot});
}

std::string stack_svg(const std::vector<Plot>& plots) {
  int height = 0;
  int width = 0;
  std::string titles;
  for (const Plot& plot : plots) {
    titles += (titles.empty() ? "" : "; ") + (plot.title.empty() ? plot.y.label : plot.title);
    height += total_height(plot);
    width = std::max(width, plot.width);
  }
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#4a515c\" role=\"img\" "
      "aria-label=\"{2}\"><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>",
      width, height, escape_xml(titles));
  // Clip paths need names of their own when several pictures stand in one page: take them from what is drawn.
  std::size_t hash = 0;
  for (const Plot& plot : plots)
    hash = hash * 31 + std::hash<std::string>{}(plot.title + plot.y.label + plot.x.label);
  int offset = 0;
  for (const Plot& plot : plots) {
    out += plot_group(plot, offset, hash % 100000000);
    offset += total_height(plot);
  }
  out += "</svg>\n";
  return out;
}

}  // namespace bodesmith::report
