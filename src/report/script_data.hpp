#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "report/plot.hpp"
#include "report/table.hpp"

namespace bodesmith::report {

/// JSON to stand in a page's `<script type="application/json">`: no text in it can end that element or begin another one.
/// Bytes that are no UTF-8 are replaced.
std::string json_for_script(const Json& json);

/// `value` with `digits` significant ones, for data that people read off a plot; null when it is not finite.
Json plotted_number(double value, int digits);

/// The part of an axis' label that is a unit: "Hz" of "frequency, Hz", "dB" of "dB"; empty: it names none.
std::string unit_of_label(const std::string& label);

/// Plots for the page's script: axes with quantity, unit and whole range, traces that share columns of x.
///   {"columns": [[…]], "plots": [{"title", "height", "x": {"label", "quantity", "unit", "log", "from", "to"}, "y": {…},
///    "traces": [{"name", "x": column, "y": […], "style", "colour", "width", "shown", "samples"}]}]}
/// x with 9 significant digits, y with 7. A long series is thinned to kMostLivePoints; "samples" is what it had.
Json live_plots(const std::vector<Plot>& plots);

/// {"chosen", "choices": [{"name", "figures": [[value, meaning]], "plots": as live_plots(), "notes", "tables": [{"caption",
/// "head", "rows", "marked"}]}]}.
Json choices_json(const std::vector<Choice>& choices, std::size_t chosen);

inline constexpr std::size_t kMostLivePoints = 4000;

}  // namespace bodesmith::report
