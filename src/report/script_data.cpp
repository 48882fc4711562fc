#include "report/script_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "report/scale.hpp"

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
    const auto found = std::ranges::find(columns_, column);
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
  return std::ranges::find(kUnits, last) != kUnits.end() ? last : std::string();
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

namespace {

/// Which stretch a sample belongs to; nothing for one that cannot be drawn along x.
class Stretches {
 public:
  Stretches(const std::vector<double>& x, std::size_t count, bool logarithmic)
      : x_(x), count_(static_cast<double>(count)), logarithmic_(logarithmic) {
    std::optional<double> last;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::optional<double> place = place_of(i);
      if (!place) continue;
      if (!last) from_ = *place;
      if (last && *place < *last) sorted_ = false;
      last = place;
    }
    if (last) to_ = *last;
  }

  std::optional<double> number_of(std::size_t i) const {
    const std::optional<double> place = place_of(i);
    if (!place) return std::nullopt;
    if (!sorted_ || !(to_ > from_))
      return std::floor(count_ * static_cast<double>(i) / static_cast<double>(x_.size()));
    return std::min(count_ - 1.0, std::floor(count_ * (*place - from_) / (to_ - from_)));
  }

 private:
  const std::vector<double>& x_;
  double count_;
  bool logarithmic_;
  bool sorted_ = true;
  double from_ = 0.0;
  double to_ = 0.0;

  std::optional<double> place_of(std::size_t i) const {
    if (!std::isfinite(x_[i]) || (logarithmic_ && x_[i] <= 0.0)) return std::nullopt;
    return logarithmic_ ? std::log(x_[i]) : x_[i];
  }
};

/// Of one stretch: where y is lowest, where it is highest, and where it has no value.
struct Kept {
  std::optional<std::size_t> lowest, highest, gap;

  void add(std::size_t i, const std::vector<double>& y) {
    if (!std::isfinite(y[i])) {
      gap = i;
      return;
    }
    if (!lowest || y[i] < y[*lowest]) lowest = i;
    if (!highest || y[i] > y[*highest]) highest = i;
  }
};

}  // namespace

Series thinned(Series series, std::size_t most, bool logarithmic) {
  const std::size_t n = std::min(series.x.size(), series.y.size());
  if (n <= most) return series;
  series.x.resize(n);
  const Stretches stretches(series.x, std::max<std::size_t>(1, most / 2), logarithmic);
  std::vector<double> x;
  std::vector<double> y;
  const auto put = [&](const Kept& kept) {
    std::array<std::optional<std::size_t>, 3> at{kept.lowest, kept.highest, kept.gap};
    std::ranges::sort(at);
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (!at[k] || (k > 0 && at[k] == at[k - 1])) continue;
      x.push_back(series.x[*at[k]]);
      y.push_back(series.y[*at[k]]);
    }
  };
  Kept kept;
  std::optional<double> now;
  for (std::size_t i = 0; i < n; ++i) {
    const std::optional<double> stretch = stretches.number_of(i);
    if (!stretch) continue;
    if (now && *stretch != *now) {
      put(kept);
      kept = {};
    }
    now = stretch;
    kept.add(i, series.y);
  }
  put(kept);
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

}  // namespace bodesmith::report
