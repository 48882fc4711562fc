#include "report/script_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "base/json.hpp"
#include "base/text.hpp"
#include "report/scale.hpp"
#include "report/thin.hpp"

namespace bodesmith::report {
namespace {

constexpr int kDigitsOfX = 9;
constexpr int kDigitsOfY = 7;

const char* style_name(Series::Style style) {
  switch (style) {
    case Series::Style::dashed:
      return "dashed";
    case Series::Style::marks:
      return "marks";
    case Series::Style::line:
      break;
  }
  return "line";
}

Json numbers(const std::vector<double>& values, std::size_t count, int digits) {
  Json out = Json::array();
  for (std::size_t i = 0; i < count; ++i) out.push_back(plotted_number(values[i], digits));
  return out;
}

Json axis_json(const Axis& axis, Range range) {
  const Scale scale = make_scale(axis, range, 0.0, 1.0);
  const std::string unit = unit_of_label(axis.label);
  std::string quantity = axis.label.substr(0, axis.label.size() - unit.size());
  while (quantity.ends_with(' ') || quantity.ends_with(',')) quantity.pop_back();
  return {{"label", axis.label},      {"quantity", quantity}, {"unit", unit},
          {"log", scale.logarithmic}, {"from", scale.from},   {"to", scale.to}};
}

/// Columns of x, each once.
class Columns {
 public:
  std::size_t number_of(Json column) {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    if (found != columns_.end()) return static_cast<std::size_t>(found - columns_.begin());
    columns_.push_back(std::move(column));
    return columns_.size() - 1;
  }
  Json json() const { return columns_; }

 private:
  std::vector<Json> columns_;
};

Json trace_json(const Series& given, const Plot& plot, std::size_t place, Columns& columns) {
  const Series series = thinned(given, kMostLivePoints, plot.x.logarithmic);
  const std::size_t count = std::min(series.x.size(), series.y.size());
  return {{"name", series.name},
          {"x", columns.number_of(numbers(series.x, count, kDigitsOfX))},
          {"y", numbers(series.y, count, kDigitsOfY)},
          {"style", style_name(series.style)},
          {"colour", series.color >= 0 ? static_cast<std::size_t>(series.color) : place},
          {"width", series.width},
          {"shown", series.shown},
          {"samples", std::min(given.x.size(), given.y.size())}};
}

}  // namespace

std::string json_for_script(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  // Outside strings JSON has none of these, so that each may be written as its escape.
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else if (c == '>') {
      out += "\\u003e";
    } else if (c == '&') {
      out += "\\u0026";
    } else {
      out += c;
    }
  }
  return out;
}

Json plotted_number(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  double rounded = value;
  parse_number(fmt::format("{:.{}g}", value, digits), rounded);
  if (rounded == std::trunc(rounded) && std::abs(rounded) < 1e9) return static_cast<std::int64_t>(rounded);
  return rounded;
}

std::string unit_of_label(const std::string& label) {
  static constexpr std::array<std::string_view, 15> kUnits = {
      "Hz",   "s", "dB", "degrees", "V", "A",          "m",
      "Ω",    "F", "um", "rad/s",   "%", "% of range", "% of the fundamental",
      "parts"};
  const std::size_t comma = label.rfind(", ");
  const std::string last = comma == std::string::npos ? label : label.substr(comma + 2);
  return std::find(kUnits.begin(), kUnits.end(), last) != kUnits.end() ? last : std::string();
}

Json choices_json(const std::vector<Choice>& choices, std::size_t chosen) {
  Json out = {{"chosen", chosen}, {"choices", Json::array()}};
  for (const Choice& choice : choices) {
    Json figures = Json::array();
    for (const auto& [value, meaning] : choice.figures) figures.push_back({value, meaning});
    Json tables = Json::array();
    for (const auto& [table, caption] : choice.tables) {
      tables.push_back(
          {{"caption", caption}, {"head", table.head}, {"rows", table.rows}, {"marked", table.marked}});
    }
    out["choices"].push_back({{"name", choice.name},
                              {"figures", std::move(figures)},
                              {"plots", live_plots(choice.plots)},
                              {"notes", choice.notes},
                              {"tables", std::move(tables)}});
  }
  return out;
}

Json live_plots(const std::vector<Plot>& plots) {
  Columns columns;
  Json out = {{"plots", Json::array()}};
  for (const Plot& plot : plots) {
    Json traces = Json::array();
    for (std::size_t i = 0; i < plot.series.size(); ++i)
      traces.push_back(trace_json(plot.series[i], plot, i, columns));
    const Range y = with_margin(data_range(plot, &Series::y, plot.y.logarithmic), plot.y.logarithmic);
    out["plots"].push_back({{"title", plot.title},
                            {"height", plot.height},
                            {"x", axis_json(plot.x, data_range(plot, &Series::x, plot.x.logarithmic))},
                            {"y", axis_json(plot.y, y)},
                            {"traces", std::move(traces)}});
  }
  out["columns"] = columns.json();
  return out;
}

}  // namespace bodesmith::report
