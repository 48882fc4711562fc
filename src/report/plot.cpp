#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "base/text.hpp"

namespace bodesmith::report {
namespace {

constexpr int kLeft = 72;
constexpr int kRight = 18;
constexpr int kTop = 34;
constexpr int kBottom = 48;
constexpr int kLegendRow = 18;

/// Data range of one coordinate over all series; {0, 1} when there is nothing to show.
void data_range(const Plot& plot, bool x, bool logarithmic, double& low, double& high) {
  low = INFINITY;
  high = -INFINITY;
  for (const Series& series : plot.series) {
    for (const double value : x ? series.x : series.y) {
      if (!std::isfinite(value) || (logarithmic && value <= 0.0)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (low > high) {
    low = logarithmic ? 1.0 : 0.0;
    high = logarithmic ? 10.0 : 1.0;
  }
}

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
};

Scale make_scale(const Plot& plot, bool x, double pixel_from, double pixel_to) {
  const Axis& axis = x ? plot.x : plot.y;
  double low = axis.from;
  double high = axis.to;
  if (!axis.fixed) {
    data_range(plot, x, axis.logarithmic, low, high);
    if (!x && axis.logarithmic) {
      low = std::pow(10.0, std::floor(std::log10(low)));
      high = std::pow(10.0, std::ceil(std::log10(high)));
    } else if (!x) {
      const double margin = high > low ? 0.06 * (high - low) : std::max(1e-12, 0.1 * std::abs(high));
      low -= margin;
      high += margin;
    }
  }
  if (!(high > low)) high = axis.logarithmic ? low * 10.0 : low + 1.0;
  return {axis.logarithmic, low, high, pixel_from, pixel_to};
}

std::string tick_text(double value) {
  if (value != 0.0 && (std::abs(value) >= 1e5 || std::abs(value) < 1e-3)) {
    const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value)) + 1e-9));
    const double mantissa = value / std::pow(10.0, exponent);
    if (std::abs(mantissa - 1.0) < 1e-9) return fmt::format("1e{}", exponent);
    return fmt::format("{:.3g}e{}", mantissa, exponent);
  }
  return fmt::format("{:.6g}", value);
}

struct LegendLayout {
  struct Entry {
    size_t series;
    int column_x;
    int row;
  };
  std::vector<Entry> entries;
  int rows = 0;
};

/// Names set in rows below the diagram.
LegendLayout lay_out_legend(const Plot& plot) {
  LegendLayout legend;
  int x = kLeft;
  int row = 0;
  for (size_t i = 0; i < plot.series.size(); ++i) {
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

int color_of(const Plot& plot, size_t i) {
  return plot.series[i].color >= 0 ? plot.series[i].color : static_cast<int>(i);
}

void draw_series(const Plot& plot, size_t index, const Scale& sx, const Scale& sy, std::string& out) {
  const Series& series = plot.series[index];
  const std::string color = palette_color(color_of(plot, index));
  auto sink = std::back_inserter(out);
  const size_t n = std::min(series.x.size(), series.y.size());
  if (series.style == Series::Style::marks) {
    for (size_t i = 0; i < n; ++i) {
      if (!sx.drawable(series.x[i]) || !sy.drawable(series.y[i])) continue;
      fmt::format_to(
          sink,
          "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"3.6\" fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.8\"/>",
          sx.pixel(series.x[i]), sy.pixel(series.y[i]), color);
    }
    return;
  }
  std::string path;
  auto path_sink = std::back_inserter(path);
  bool pen_down = false;
  // Long records: at a pixel column only its lowest and highest value can be seen.
  const size_t stride_limit = 4000;
  if (n <= stride_limit) {
    for (size_t i = 0; i < n; ++i) {
      if (!sx.drawable(series.x[i]) || !sy.drawable(series.y[i])) {
        pen_down = false;
        continue;
      }
      fmt::format_to(path_sink, "{}{:.2f} {:.2f}", pen_down ? "L" : "M", sx.pixel(series.x[i]),
                     sy.pixel(series.y[i]));
      pen_down = true;
    }
  } else {
    size_t i = 0;
    while (i < n) {
      if (!sx.drawable(series.x[i]) || !sy.drawable(series.y[i])) {
        pen_down = false;
        ++i;
        continue;
      }
      const double column = std::floor(sx.pixel(series.x[i]) * 2.0);
      size_t lowest = i;
      size_t highest = i;
      const size_t first = i;
      while (i < n && sx.drawable(series.x[i]) && sy.drawable(series.y[i]) &&
             std::floor(sx.pixel(series.x[i]) * 2.0) == column) {
        if (series.y[i] < series.y[lowest]) lowest = i;
        if (series.y[i] > series.y[highest]) highest = i;
        ++i;
      }
      std::array<size_t, 4> shown{first, std::min(lowest, highest), std::max(lowest, highest), i - 1};
      size_t previous = n;
      for (const size_t k : shown) {
        if (k == previous) continue;
        previous = k;
        fmt::format_to(path_sink, "{}{:.2f} {:.2f}", pen_down ? "L" : "M", sx.pixel(series.x[k]),
                       sy.pixel(series.y[k]));
        pen_down = true;
      }
    }
  }
  fmt::format_to(
      sink, "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}/>",
      path, color, series.width, series.style == Series::Style::dashed ? " stroke-dasharray=\"6 4\"" : "");
}

/// The plot's elements without the <svg> around them, moved down by `offset`.
std::string body(const Plot& plot, int offset, int clip_number) {
  std::string out;
  auto sink = std::back_inserter(out);
  const double right = plot.width - kRight;
  const double bottom = plot.height - kBottom;
  const Scale sx = make_scale(plot, true, kLeft, right);
  const Scale sy = make_scale(plot, false, bottom, kTop);
  fmt::format_to(sink, "<g transform=\"translate(0 {})\">", offset);
  fmt::format_to(sink,
                 "<text x=\"{}\" y=\"20\" font-size=\"14\" font-weight=\"600\" fill=\"#1b1f24\">{}</text>",
                 kLeft, escape_xml(plot.title));

  const auto ticks_of = [](const Scale& scale, int wanted) {
    return scale.logarithmic ? logarithmic_ticks(scale.from, scale.to)
                             : linear_ticks(scale.from, scale.to, wanted);
  };
  if (sx.logarithmic) {
    for (double decade = std::pow(10.0, std::floor(std::log10(sx.from))); decade < sx.to; decade *= 10.0) {
      for (int k = 2; k <= 9; ++k) {
        const double value = decade * k;
        if (value < sx.from || value > sx.to) continue;
        fmt::format_to(sink, "<path d=\"M{0:.2f} {1}V{2}\" stroke=\"#f0f1f3\"/>", sx.pixel(value), kTop,
                       bottom);
      }
    }
  }
  for (const double value : ticks_of(sx, 8)) {
    fmt::format_to(sink, "<path d=\"M{0:.2f} {1}V{2}\" stroke=\"#dcdfe4\"/>", sx.pixel(value), kTop, bottom);
    fmt::format_to(sink, "<text x=\"{:.2f}\" y=\"{}\" text-anchor=\"middle\">{}</text>", sx.pixel(value),
                   bottom + 17, tick_text(value));
  }
  for (const double value : ticks_of(sy, std::max(3, (plot.height - kTop - kBottom) / 45))) {
    fmt::format_to(sink, "<path d=\"M{} {:.2f}H{}\" stroke=\"#dcdfe4\"/>", kLeft, sy.pixel(value), right);
    fmt::format_to(sink, "<text x=\"{}\" y=\"{:.2f}\" text-anchor=\"end\">{}</text>", kLeft - 7,
                   sy.pixel(value) + 4, tick_text(value));
  }
  fmt::format_to(
      sink,
      "<clipPath id=\"plot-{0}-{1}\"><rect x=\"{2}\" y=\"{3}\" width=\"{4}\" height=\"{5}\"/></clipPath>",
      clip_number, offset, kLeft, kTop, right - kLeft, bottom - kTop);
  fmt::format_to(sink, "<g clip-path=\"url(#plot-{}-{})\">", clip_number, offset);
  for (size_t i = 0; i < plot.series.size(); ++i) draw_series(plot, i, sx, sy, out);
  fmt::format_to(sink,
                 "</g><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#8a919c\"/>",
                 kLeft, kTop, right - kLeft, bottom - kTop);
  fmt::format_to(sink, "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\" fill=\"#1b1f24\">{}</text>",
                 (kLeft + right) / 2, plot.height - 12, escape_xml(plot.x.label));
  fmt::format_to(sink,
                 "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\" "
                 "fill=\"#1b1f24\">{}</text>",
                 (kTop + bottom) / 2, escape_xml(plot.y.label));
  for (const auto& entry : lay_out_legend(plot).entries) {
    const Series& series = plot.series[entry.series];
    const std::string color = palette_color(color_of(plot, entry.series));
    const int y = plot.height + entry.row * kLegendRow + 4;
    if (series.style == Series::Style::marks) {
      fmt::format_to(
          sink, "<circle cx=\"{}\" cy=\"{}\" r=\"3.6\" fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.8\"/>",
          entry.column_x + 12, y - 4, color);
    } else {
      fmt::format_to(sink, "<path d=\"M{} {}h24\" stroke=\"{}\" stroke-width=\"{}\"{}/>", entry.column_x,
                     y - 4, color, series.width,
                     series.style == Series::Style::dashed ? " stroke-dasharray=\"6 4\"" : "");
    }
    fmt::format_to(sink, "<text x=\"{}\" y=\"{}\" fill=\"#1b1f24\">{}</text>", entry.column_x + 30, y,
                   escape_xml(series.name));
  }
  out += "</g>";
  return out;
}

}  // namespace

std::string palette_color(int index) {
  static constexpr std::array<const char*, 8> kPalette = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                          "#56b4e9", "#e69f00", "#4d4d4d", "#8c564b"};
  return kPalette[static_cast<size_t>(index) % kPalette.size()];
}

std::string escape_xml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::vector<double> linear_ticks(double from, double to, int wanted) {
  std::vector<double> ticks;
  if (!(to > from) || wanted < 1) return ticks;
  const double raw = (to - from) / wanted;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  double step = decade;
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    step = factor * decade;
    if (step >= raw * 0.999) break;
  }
  for (double k = std::ceil(from / step - 1e-9); k * step <= to + 1e-9 * step && ticks.size() < 100;
       k += 1.0) {
    ticks.push_back(k == 0.0 ? 0.0 : k * step);
  }
  return ticks;
}

std::vector<double> logarithmic_ticks(double from, double to) {
  std::vector<double> ticks;
  const double decades = std::log10(to / from);
  // Many decades: every second or third one, so that the numbers do not run into one another.
  const int stride = std::max(1, static_cast<int>(std::ceil(decades / 9.0)));
  const int first = static_cast<int>(std::floor(std::log10(from)));
  const int last = static_cast<int>(std::ceil(std::log10(to)));
  for (int e = first; e <= last; ++e) {
    if (((e % stride) + stride) % stride != 0) continue;
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor > 1.0 && decades > 2.0) continue;
      const double value = factor * std::pow(10.0, e);
      if (value >= from * (1.0 - 1e-9) && value <= to * (1.0 + 1e-9)) ticks.push_back(value);
    }
  }
  return ticks;
}

std::string to_svg(const Plot& plot) {
  return stack_svg({plot});
}

std::string stack_svg(const std::vector<Plot>& plots) {
  int height = 0;
  int width = 0;
  for (const Plot& plot : plots) {
    height += total_height(plot);
    width = std::max(width, plot.width);
  }
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#4a515c\" role=\"img\">"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>",
      width, height);
  // Clip paths need names of their own when several pictures stand in one page: take them from what is drawn.
  size_t hash = 0;
  for (const Plot& plot : plots)
    hash = hash * 31 + std::hash<std::string>{}(plot.title + plot.y.label + plot.x.label);
  int offset = 0;
  for (const Plot& plot : plots) {
    out += body(plot, offset, static_cast<int>(hash % 100000000));
    offset += total_height(plot);
  }
  out += "</svg>\n";
  return out;
}

}  // namespace bodesmith::report
