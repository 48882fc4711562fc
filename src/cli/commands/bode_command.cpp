#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hertz_values.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "cli/commands.hpp"
#include "cli/modes/bode_loop.hpp"
#include "cli/response_source.hpp"
#include "cli/shared_options.hpp"
#include "report/plot.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::cli {
namespace {

/// Two files of the same stem get columns of different names.
void make_stems_unique(std::vector<ResponseSource>& sources) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::string stem = sources[i].stem;
    int number = 1;
    const auto taken = [&] {
      return std::any_of(sources.begin(), sources.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const ResponseSource& other) { return other.stem == sources[i].stem; });
    };
    while (taken()) sources[i].stem = fmt::format("{}_{}", stem, ++number);
  }
}

/// What was asked for; else a measured record's own frequencies; else a decade beyond all corners.
std::vector<Hertz> choose_grid(const CommandLine& line, const std::vector<ResponseSource>& sources) {
  const bool asked = line.has("from-hz") || line.has("to-hz") || line.has("count");
  if (!asked) {
    for (const ResponseSource& source : sources) {
      if (!source.own_frequencies.empty()) return source.own_frequencies;
    }
  }
  Band band{Hertz{INFINITY}, Hertz{0.0}};
  for (const ResponseSource& source : sources) {
    if (!source.band) continue;
    const double margin = source.own_frequencies.empty() ? 10.0 : 1.0;
    // A loop with an integrator may cross 1 a decade below its lowest corner: tune's PID does so by default.
    const double below = line.has("margins") && margin > 1.0 ? 100.0 : margin;
    band.from = std::min(band.from, Hertz{source.band->from.value / below});
    band.to = std::max(band.to, Hertz{source.band->to.value * margin});
  }
  if (band.from > band.to) band = {Hertz{1.0}, Hertz{1e5}};
  if (line.has("from-hz")) band.from = Hertz{line.positive("from-hz")};
  if (line.has("to-hz")) band.to = Hertz{line.positive("to-hz")};
  if (!(band.to >= band.from)) {
    line.fail(fmt::format("the band {} to {} Hz is empty, expected --from-hz below --to-hz", band.from.value,
                          band.to.value));
  }
  int count = line.integer("count", 1, 10'000'000);
  if (band.from == band.to) count = 1;
  if (count == 1) band.to = band.from;
  return log_grid(band, count);
}

std::string bode_csv(const std::vector<Hertz>& grid, const std::vector<ResponseSource>& sources,
                     const std::vector<LevelAndPhase>& columns,
                     const std::vector<std::vector<ExtraColumn>>& extra) {
  std::vector<std::string> names{std::string(column::frequency_hz)};
  for (std::size_t i = 0; i < sources.size(); ++i) {
    names.push_back(fmt::format("{}_{}", sources[i].stem, column::magnitude_db));
    if (!columns[i].phase_deg.empty())
      names.push_back(fmt::format("{}_{}", sources[i].stem, column::phase_deg));
    for (const ExtraColumn& more : extra[i]) names.push_back(more.name);
  }
  CsvTable table(names);
  const auto cell = [](double value) { return std::isfinite(value) ? number_text(value) : std::string(); };
  for (std::size_t row = 0; row < grid.size(); ++row) {
    std::vector<std::string> cells{number_text(grid[row].value)};
    for (std::size_t i = 0; i < columns.size(); ++i) {
      cells.push_back(cell(columns[i].magnitude_db[row]));
      if (!columns[i].phase_deg.empty()) cells.push_back(cell(columns[i].phase_deg[row]));
      for (const ExtraColumn& more : extra[i]) cells.push_back(cell(more.values[row]));
    }
    table.add_row(cells);
  }
  return table.text();
}

/// A measured record's points as marks, everything else on a dense grid, and beneath them how far apart they are.
class BodePicture {
 public:
  BodePicture(const std::vector<Hertz>& grid, const std::vector<ResponseSource>& sources,
              const std::vector<LevelAndPhase>& columns, const std::vector<std::vector<ExtraColumn>>& extra)
      : sources_(sources), dense_(dense_grid(grid)) {
    const bool same = dense_.size() == grid.size();
    for (std::size_t i = 0; i < sources.size(); ++i) {
      add(static_cast<int>(i), same ? &columns[i] : nullptr);
      for (const ExtraColumn& more : extra[i]) {
        if (more.name == sources[i].stem + "_group_delay_s") add_delay(static_cast<int>(i), grid, more);
      }
    }
  }

  std::string svg() const {
    std::vector<report::Plot> plots{plot_.magnitude, plot_.phase};
    if (plot_.phase.series.empty()) plots.pop_back();
    if (!delay_.series.empty()) plots.push_back(delay_);
    if (sources_.size() > 1 && sources_[0].own_frequencies.empty()) plots.push_back(difference());
    return report::stack_svg(plots);
  }

 private:
  static constexpr std::size_t kDense = 401;
  static constexpr std::size_t kMostMarks = 200;

  static std::vector<Hertz> dense_grid(const std::vector<Hertz>& grid) {
    if (grid.size() >= kDense || !(grid.back() > grid.front())) return grid;
    return log_grid({grid.front(), grid.back()}, static_cast<int>(kDense));
  }

  void add(int number, const LevelAndPhase* known) {
    const ResponseSource& source = sources_[static_cast<std::size_t>(number)];
    const bool marks = !source.own_frequencies.empty() && source.own_frequencies.size() <= kMostMarks;
    const std::vector<Hertz>& grid = marks ? source.own_frequencies : dense_;
    const LevelAndPhase columns = known != nullptr && !marks ? *known : source.on_grid(grid);
    report::Series series{source.stem, hertz_values(grid), columns.magnitude_db};
    series.style = marks             ? report::Series::Style::marks
                   : number % 2 == 0 ? report::Series::Style::line
                                     : report::Series::Style::dashed;
    series.color = number;
    plot_.magnitude.series.push_back(series);
    if (columns.phase_deg.empty()) return;
    series.y = columns.phase_deg;
    plot_.phase.series.push_back(std::move(series));
  }

  /// With --group-delay, on the table's own grid.
  void add_delay(int number, const std::vector<Hertz>& grid, const ExtraColumn& column) {
    delay_.title = "Group delay";
    delay_.x = plot_.magnitude.x;
    delay_.y = {"s"};
    delay_.height = 240;
    report::Series series{sources_[static_cast<std::size_t>(number)].stem, hertz_values(grid), column.values};
    series.color = number;
    delay_.series.push_back(std::move(series));
  }

  /// Of every file from the first, where both are known: curves that lie on each other are told apart here.
  report::Plot difference() const {
    report::Plot out;
    out.title = "Difference from " + sources_[0].stem;
    out.x = plot_.magnitude.x;
    out.y = {"dB"};
    out.height = 240;
    for (std::size_t i = 1; i < plot_.magnitude.series.size(); ++i) {
      report::Series series = plot_.magnitude.series[i];
      std::vector<Hertz> grid;
      for (const double f : series.x) grid.push_back(Hertz{f});
      const std::vector<double> first = sources_[0].on_grid(grid).magnitude_db;
      for (std::size_t k = 0; k < series.y.size(); ++k) series.y[k] -= first[k];
      out.series.push_back(std::move(series));
    }
    return out;
  }

  const std::vector<ResponseSource>& sources_;
  std::vector<Hertz> dense_;
  report::BodePlot plot_;
  report::Plot delay_;
};

void declare_bode(CommandLine& line) {
  line.positional("FILE...", 1, -1);
  line.band("lowest frequency", "highest frequency");
  line.option<int>("count", "number of frequencies, evenly spaced in log frequency", 200);
  add_hold_options(line);
  line.option<std::string>("subcircuit", "of a .sub file: its name", "");
  line.option<std::string>("svg", "also draw the Bode plot into this file");
  line.output("table (CSV); without it the table goes to stdout", true);
  add_loop_options(line);
}

struct DecibelRange {
  double low = INFINITY;
  double high = -INFINITY;
};

DecibelRange decibel_range(const LevelAndPhase& columns) {
  DecibelRange out;
  for (const double value : columns.magnitude_db) {
    if (!std::isfinite(value)) continue;
    out.low = std::min(out.low, value);
    out.high = std::max(out.high, value);
  }
  return out.low > out.high ? DecibelRange{0.0, 0.0} : out;
}

void print_bode_summary(const CommandLine& line, const Provenance& from, const std::vector<Hertz>& grid,
                        const std::vector<ResponseSource>& sources, const std::vector<LevelAndPhase>& columns,
                        double seconds) {
  std::string text =
      fmt::format("{} frequencies, {} to {}\n", grid.size(), engineering_text(grid.front().value, "Hz", 5),
                  engineering_text(grid.back().value, "Hz", 5));
  Json summary = {{"count", grid.size()},
                  {"band_hz", {grid.front().value, grid.back().value}},
                  {"responses", Json::array()}};
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto [low, high] = decibel_range(columns[i]);
    summary["responses"].push_back({{"name", sources[i].stem}, {"lowest_db", low}, {"highest_db", high}});
    text += fmt::format("  {}: {} to {} dB\n", sources[i].stem, rounded_text(low, 5), rounded_text(high, 5));
    text += margins_text(line, grid, {sources[i], columns[i]}, summary["responses"].back());
  }
  print_summary(line, text, timed_document("bode_summary", from, summary, seconds));
}

}  // namespace

int run_bode(const std::vector<std::string>& arguments) {
  CommandLine line(
      "bode", "bodesmith bode cascade.json sections.json plan.json compensator.sub measured.csv -o bode.csv",
      "Frequency responses of any of these files in one table: magnitude in dB and unwrapped phase in\n"
      "degrees. A measured response is interpolated in log frequency; cells outside its range stay empty.\n"
      "Without a band the grid is that of the first measured one, else a decade beyond all corners\n"
      "(with --margins two below them).");
  declare_bode(line);
  line.reads_measurements();
  if (!line.parse(arguments)) return kDone;

  Provenance from;
  std::vector<ResponseSource> sources;
  const ResponseOptions options{as_it_runs(line), line.get<std::string>("subcircuit")};
  for (const std::string& file : line.files()) sources.push_back(load_response(file, options, from));
  if (line.has("series")) {
    if (sources.size() < 2) line.fail("--series is the product of several files");
    sources.push_back(series_of(sources));
  }
  make_stems_unique(sources);
  const std::vector<Hertz> grid = choose_grid(line, sources);

  const Stopwatch watch;
  std::vector<LevelAndPhase> columns;
  for (const ResponseSource& source : sources) {
    columns.push_back(source.on_grid(grid));
    if (columns.back().phase_deg.empty()) note(source.stem + " has no phase_deg: magnitude only");
  }
  std::vector<std::vector<ExtraColumn>> extra;
  std::vector<BodeResponse> responses;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    responses.push_back({sources[i], columns[i]});
    extra.push_back(extra_columns(line, grid, responses.back()));
  }
  const double seconds = watch.seconds();

  OutputSet out;
  const bool to_file = line.has("output");
  const bool margins = line.has("margins");
  const std::string csv = bode_csv(grid, sources, columns, extra);
  if (to_file) out.add(line.output_path(), csv);
  if (line.has("svg"))
    out.add(line.get<std::string>("svg"), BodePicture(grid, sources, columns, extra).svg());
  add_loop_files(line, responses, out);
  if (!to_file) line.refuse_unread();
  out.commit();
  // Without -o the table is the answer, unless margins were asked for.
  if (!to_file && !line.json() && !margins) {
    note_conversions(from);
    hide_progress();
    fmt::print("{}", csv);
    return kDone;
  }
  print_bode_summary(line, from, grid, sources, columns, seconds);
  return kDone;
}

}  // namespace bodesmith::cli
