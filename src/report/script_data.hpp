#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "report/plot.hpp"

namespace bodesmith::report {

/// A table of a page. Cells are plain text; `marked` rows are set off (a limit missed, the best choice).
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> marked;
};

/// A row of a table that can be chosen, and what is then shown of it. Every choice of a table has the same plots.
struct Choice {
  std::string name;
  std::vector<std::pair<std::string, std::string>> figures;  ///< value and meaning
  std::vector<Plot> plots;
  std::vector<std::string> notes;                     ///< that must not be missed
  std::vector<std::pair<Table, std::string>> tables;  ///< and their captions
};

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

/// A series of at most about 1.5 times `most` points in the order of the given one: of every stretch the lowest and the highest,
/// so that peaks survive, and a gap where the stretch has one. Stretches are equally wide along x as it is drawn (`logarithmic`:
/// per decade, samples without a place there are left out); of a series whose x goes back and forth, equally long. Series of at most
/// `most` points stay as they are.
Series thinned(Series series, std::size_t most, bool logarithmic = false);

}  // namespace bodesmith::report
