#include "report/bars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "report/scale.hpp"
#include "report/svg.hpp"

namespace bodesmith::report {
namespace {

constexpr int kBarsWidth = 900;
constexpr int kBarsLeft = 220;   ///< room for the labels
constexpr int kBarsRight = 130;  ///< and for the figures
constexpr int kBarsTop = 34;
constexpr int kBarHeight = 13;
constexpr int kBetweenGroups = 12;  ///< groups
constexpr int kBarsBottom = 64;

/// From 0 to the largest value.
Range bars_range(const Bars& bars) {
  double high = bars.line;
  for (const Bars::Group& group : bars.groups) {
    for (const double value : group.values) high = std::isfinite(value) ? std::max(high, value) : high;
  }
  return {0.0, high > 0.0 ? high : 1.0};
}

}  // namespace

std::string to_svg(const Bars& bars) {
  const int right = kBarsWidth - kBarsRight;
  const Scale scale = make_scale(Axis{}, bars_range(bars), kBarsLeft, right);
  const int group_height = kBarHeight * static_cast<int>(bars.names.size()) + kBetweenGroups;
  const int bottom = kBarsTop + group_height * static_cast<int>(bars.groups.size()) + kBetweenGroups;
  std::string out;
  auto sink = std::back_inserter(out);
  fmt::format_to(
      sink,
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#4a515c\" role=\"img\" aria-label=\"{3}\">"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>"
      "<text x=\"{2}\" y=\"20\" font-size=\"14\" font-weight=\"600\" fill=\"#1b1f24\">{3}</text>",
      kBarsWidth, bottom + kBarsBottom, kBarsLeft, escape_xml(bars.title));
  for (const double tick : scale.ticks(8)) {
    fmt::format_to(sink,
                   "<path d=\"M{0:.2f} {1}V{2}\" stroke=\"#dcdfe4\"/>"
                   "<text x=\"{0:.2f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>",
                   scale.pixel(tick), kBarsTop, bottom, bottom + 16, tick_text(tick));
  }
  int y = kBarsTop + kBetweenGroups;
  for (const Bars::Group& group : bars.groups) {
    fmt::format_to(sink, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"#1b1f24\">{}</text>",
                   kBarsLeft - 8, y + (group_height - kBetweenGroups) / 2 + 4, escape_xml(group.label));
    for (std::size_t i = 0; i < group.values.size(); ++i, y += kBarHeight) {
      if (!std::isfinite(group.values[i])) continue;
      const double end = scale.pixel(group.values[i]);
      fmt::format_to(sink,
                     "<rect x=\"{}\" y=\"{}\" width=\"{:.2f}\" height=\"{}\" fill=\"{}\"/>"
                     "<text x=\"{:.2f}\" y=\"{}\">{}</text>",
                     kBarsLeft, y, end - kBarsLeft, kBarHeight - 2, palette_colour(static_cast<int>(i)),
                     end + 6, y + kBarHeight - 3, escape_xml(group.texts[i]));
    }
    y += kBetweenGroups;
  }
  int x = kBarsLeft;
  const int legend = bottom + 54;
  for (std::size_t i = 0; i < bars.names.size(); ++i) {
    fmt::format_to(
        sink,
        "<rect x=\"{}\" y=\"{}\" width=\"24\" height=\"10\" fill=\"{}\"/><text x=\"{}\" y=\"{}\">{}</text>",
        x, legend - 9, palette_colour(static_cast<int>(i)), x + 30, legend, escape_xml(bars.names[i]));
    x += 50 + 7 * static_cast<int>(bars.names[i].size());
  }
  if (bars.line > 0.0) {
    fmt::format_to(
        sink,
        "<path d=\"M{0:.2f} {1}V{2}\" stroke=\"#1b1f24\" stroke-dasharray=\"6 4\"/>"
        "<path d=\"M{3} {4}h24\" stroke=\"#1b1f24\" stroke-dasharray=\"6 4\"/><text x=\"{5}\" y=\"{6}\">{7}</text>",
        scale.pixel(bars.line), kBarsTop, bottom, x, legend - 4, x + 30, legend, escape_xml(bars.line_name));
  }
  fmt::format_to(sink, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"#1b1f24\">{}</text></svg>",
                 (kBarsLeft + right) / 2, bottom + 34, escape_xml(bars.axis));
  return out;
}

}  // namespace bodesmith::report
