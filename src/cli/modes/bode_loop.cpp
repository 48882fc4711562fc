#include "cli/modes/bode_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "lti/bulk_response.hpp"
#include "lti/loop_margins.hpp"
#include "lti/section_making.hpp"
#include "lti/time_response.hpp"
#include "report/plot.hpp"
#include "signal/csv.hpp"

namespace bodesmith::cli {
namespace {

/// The response on the grid where it has magnitude and phase; NaN elsewhere.
std::vector<Complex> complex_column(const LevelAndPhase& columns) {
  std::vector<Complex> out(columns.magnitude_db.size(), Complex(NAN, NAN));
  for (std::size_t i = 0; i < columns.phase_deg.size(); ++i) {
    if (std::isfinite(columns.magnitude_db[i]) && std::isfinite(columns.phase_deg[i]))
      out[i] = std::polar(from_decibel(columns.magnitude_db[i]), to_radians(columns.phase_deg[i]));
  }
  return out;
}

/// A response at any frequency of the grid's band: computed, or between the grid's values in log frequency.
struct LoopOnBand {
  Loop at;
  std::vector<Hertz> grid;  ///< where crossings are looked for
};

LoopOnBand measured_loop(const std::vector<Hertz>& grid, const BodeResponse& response) {
  LoopOnBand out;
  std::vector<Complex> values;
  const auto column = complex_column(response.columns);
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (!std::isfinite(std::abs(column[i]))) continue;
    values.push_back(column[i]);
    out.grid.push_back(grid[i]);
  }
  out.at = interpolated_loop(out.grid, std::move(values));
  return out;
}

LoopOnBand loop_on_band(const std::vector<Hertz>& grid, const BodeResponse& response) {
  if (!response.source.quick) return measured_loop(grid, response);
  constexpr int kFinest = 4000;
  LoopOnBand out;
  out.at = [&source = response.source](Hertz f) { return source.response({f}).front(); };
  out.grid = grid.size() > kFinest ? grid : log_grid({grid.front(), grid.back()}, kFinest);
  return out;
}

std::vector<double> group_delays(const std::vector<Hertz>& grid, const BodeResponse& response) {
  std::vector<double> out(grid.size(), NAN);
  const ResponseSource& source = response.source;
  if (source.sections || source.quick) {
    const Loop at = [&source](Hertz f) { return source.response({f}).front(); };
    for (std::size_t i = 0; i < grid.size(); ++i)
      out[i] =
          source.sections ? group_delay_s(*source.sections, grid[i].rad_s()) : group_delay_s(at, grid[i]);
    return out;
  }
  // Measured: the slope of the phase between the neighbours.
  const auto& phase = response.columns.phase_deg;
  for (std::size_t i = 1; i + 1 < phase.size(); ++i)
    out[i] = -(phase[i + 1] - phase[i - 1]) / 360.0 / (grid[i + 1].value - grid[i - 1].value);
  return out;
}

report::Series curve(const std::string& name, int color) {
  report::Series series;
  series.name = name;
  series.color = color;
  return series;
}

void add_critical_point(report::Plot& plot, double x, double y) {
  report::Series point = curve("-1", 7);
  point.x = {x};
  point.y = {y};
  point.style = report::Series::Style::marks;
  plot.series.push_back(point);
}

/// With --series the product alone: its factors are no loops.
bool is_drawn(const CommandLine& line, const BodeResponse& response) {
  return !line.has("series") || response.source.stem == "series";
}

/// The plane around -1, where a loop's margins are: what lies farther out (an integrator's rise) breaks the line.
std::string nyquist_svg(const CommandLine& line, const std::vector<BodeResponse>& responses) {
  constexpr double kReach = 3.0;
  report::Plot plot;
  plot.title = "Nyquist, the plane around -1";
  plot.x.label = "real part";
  plot.y.label = "imaginary part";
  plot.x.fixed = plot.y.fixed = true;
  plot.x.from = -1.0 - kReach;
  plot.x.to = -1.0 + kReach;
  // One unit is as long upwards as to the right, but for the axes' margins.
  plot.height = plot.width * 2 / 3;
  plot.y.from = -kReach * 2.0 / 3.0;
  plot.y.to = kReach * 2.0 / 3.0;
  for (std::size_t i = 0; i < responses.size(); ++i) {
    if (!is_drawn(line, responses[i])) continue;
    report::Series series = curve(responses[i].source.stem, static_cast<int>(i));
    for (const Complex h : complex_column(responses[i].columns)) {
      const bool inside = std::abs(h.real() + 1.0) <= kReach && std::abs(h.imag()) <= plot.y.to;
      series.x.push_back(inside ? h.real() : NAN);
      series.y.push_back(inside ? h.imag() : NAN);
    }
    plot.series.push_back(series);
  }
  report::Series circle = curve("gain 1", 6);
  circle.style = report::Series::Style::dashed;
  for (int degrees = 0; degrees <= 360; degrees += 3) {
    circle.x.push_back(std::cos(to_radians(degrees)));
    circle.y.push_back(std::sin(to_radians(degrees)));
  }
  plot.series.push_back(circle);
  add_critical_point(plot, -1.0, 0.0);
  return report::to_svg(plot);
}

std::string nichols_svg(const CommandLine& line, const std::vector<BodeResponse>& responses) {
  report::Plot plot;
  plot.title = "Nichols";
  plot.x.label = "open-loop phase in degrees";
  plot.y.label = "open-loop magnitude in dB";
  for (std::size_t i = 0; i < responses.size(); ++i) {
    if (!is_drawn(line, responses[i])) continue;
    report::Series series = curve(responses[i].source.stem, static_cast<int>(i));
    const LevelAndPhase& columns = responses[i].columns;
    if (columns.phase_deg.empty()) continue;
    series.x = columns.phase_deg;
    series.y = columns.magnitude_db;
    plot.series.push_back(series);
  }
  add_critical_point(plot, -180.0, 0.0);
  return report::to_svg(plot);
}

std::string time_response_csv(const CommandLine& line, const std::vector<BodeResponse>& responses) {
  double duration = 0.0;
  for (const BodeResponse& response : responses) {
    if (response.source.sections)
      duration = std::max(duration, response_duration_s(*response.source.sections));
  }
  if (duration == 0.0) line.fail("--time-response needs sections.json (for others: simulate)");
  duration = line.maybe_positive("duration-s").value_or(duration);
  CsvWriter csv;
  bool first = true;
  for (const BodeResponse& response : responses) {
    const std::string& stem = response.source.stem;
    if (!response.source.sections) {
      note(stem + " holds no sections: no time response (simulate has it)");
      continue;
    }
    const TimeResponse r =
        time_response(*response.source.sections, duration, line.integer("samples", 2, 10'000'000));
    if (std::exchange(first, false)) csv.add("time_s", r.time_s);
    csv.add(stem + "_step", r.step);
    csv.add(stem + "_impulse_per_s", r.impulse);
    if (r.direct != 0.0)
      note(fmt::format("{}: the impulse response also has a Dirac impulse of weight {} at {} s", stem,
                       rounded_text(r.direct, 6), rounded_text(response.source.sections->delay_s)));
    if (r.figures) {
      note(fmt::format("{}: step to {}, rise {} (10 to 90 %), overshoot {} %, within 2 % after {}", stem,
                       rounded_text(r.figures->final_value, 6), engineering_text(r.figures->rise_s, "s", 4),
                       rounded_text(r.figures->overshoot_percent, 4),
                       engineering_text(r.figures->settling_s, "s", 4)));
    }
  }
  return csv.text();
}

}  // namespace

void add_loop_options(CommandLine& line) {
  line.group("Loops and time");
  line.flag("series", "also the product of all files: one after the other, without loading each other");
  line.flag("margins",
            "of each response as an open loop (with --series: of the product): gain, phase and delay margin");
  line.flag("group-delay", "also a column of -d(phase)/d(angular frequency) in s");
  line.flag("nyquist", "also columns of real and imaginary part");
  line.flag("nichols",
            "also columns of the closed loop L/(1 + L), to go with the open loop's dB and degrees");
  line.option<std::string>("nyquist-svg", "draw imaginary over real part into this file");
  line.option<std::string>("nichols-svg", "draw dB over degrees of the open loop into this file");
  line.option<std::string>("time-response", "write step and impulse responses of sections into this CSV");
  line.option<double>("duration-s",
                      "length of --time-response (default: until the slowest mode has decayed to 1e-3)");
  line.option<int>("samples", "number of samples of --time-response", 501);
}

ResponseSource series_of(const std::vector<ResponseSource>& sources) {
  ResponseSource out;
  out.stem = "series";
  out.quick = std::ranges::all_of(sources, [](const ResponseSource& s) { return s.quick; });
  std::vector<Sections> parts;
  for (const ResponseSource& source : sources) {
    if (source.sections) parts.push_back(*source.sections);
  }
  if (parts.size() == sources.size()) out.sections = in_series(parts);
  out.on_grid = [sources](const std::vector<Hertz>& grid) {
    LevelAndPhase sum = sources.front().on_grid(grid);
    for (std::size_t i = 1; i < sources.size(); ++i) {
      const LevelAndPhase next = sources[i].on_grid(grid);
      if (next.phase_deg.empty()) sum.phase_deg.clear();
      const auto add = [](std::vector<double>& to, const std::vector<double>& value) {
        for (std::size_t k = 0; k < to.size(); ++k) to[k] += value[k];
      };
      add(sum.magnitude_db, next.magnitude_db);
      add(sum.phase_deg, next.phase_deg);
    }
    return sum;
  };
  if (out.quick) {
    out.response = [sources](const std::vector<Hertz>& grid) {
      std::vector<Complex> product = sources.front().response(grid);
      for (std::size_t i = 1; i < sources.size(); ++i) {
        const std::vector<Complex> next = sources[i].response(grid);
        for (std::size_t k = 0; k < grid.size(); ++k) product[k] *= next[k];
      }
      return product;
    };
  }
  return out;
}

std::vector<ExtraColumn> extra_columns(const CommandLine& line, const std::vector<Hertz>& grid,
                                       const BodeResponse& response) {
  std::vector<ExtraColumn> out;
  const std::string& stem = response.source.stem;
  if (response.columns.phase_deg.empty()) return out;
  if (line.has("group-delay")) out.push_back({stem + "_group_delay_s", group_delays(grid, response)});
  const auto add = [&](const std::string& name, auto value) {
    ExtraColumn column{stem + name, {}};
    for (const Complex h : complex_column(response.columns)) column.values.push_back(value(h));
    out.push_back(std::move(column));
  };
  if (line.has("nyquist")) {
    add("_re", [](Complex h) { return h.real(); });
    add("_im", [](Complex h) { return h.imag(); });
  }
  if (line.has("nichols")) {
    add("_closed_magnitude_db", [](Complex h) { return to_decibel(std::abs(h / (1.0 + h))); });
    add("_closed_phase_deg", [](Complex h) { return to_degrees(std::arg(h / (1.0 + h))); });
  }
  return out;
}

std::string margins_text(const CommandLine& line, const std::vector<Hertz>& grid,
                         const BodeResponse& response, Json& summary) {
  const std::string& stem = response.source.stem;
  if (!line.has("margins") || (line.has("series") && stem != "series")) return "";
  if (response.columns.phase_deg.empty()) return fmt::format("  {}: no phase, no margins\n", stem);
  const LoopOnBand loop = loop_on_band(grid, response);
  if (loop.grid.size() < 2) return fmt::format("  {}: fewer than two points, no margins\n", stem);
  const LoopMargins m = loop_margins(loop.at, loop.grid);
  Json json = to_json(m);
  std::string text = fmt::format("  {} as an open loop:", stem);
  const auto* phase = m.least_phase_margin();
  const auto* gain = m.least_gain_margin();
  text += phase != nullptr ? fmt::format(" phase margin {}° at {} (delay margin {})",
                                         rounded_text(phase->phase_margin_deg, 4),
                                         engineering_text(phase->frequency.value, "Hz", 5),
                                         engineering_text(phase->delay_margin_s, "s", 4))
                           : std::string(" its gain does not cross 1 here");
  text += gain != nullptr ? fmt::format(", gain margin {} dB at {}", rounded_text(gain->gain_margin_db, 4),
                                        engineering_text(gain->frequency.value, "Hz", 5))
                          : std::string(", its phase does not cross -180° here");
  text += fmt::format(", largest sensitivity {} at {}", rounded_text(m.max_sensitivity, 4),
                      engineering_text(m.max_sensitivity_at.value, "Hz", 4));
  if (m.gain_crossings.size() > 1 || m.phase_crossings.size() > 1)
    text += fmt::format(" ({} crossings of the gain, {} of the phase; these are the nearest to instability)",
                        m.gain_crossings.size(), m.phase_crossings.size());
  if (response.source.sections) {
    const auto stable = closed_loop_is_stable(*response.source.sections);
    json["closed_loop_stable"] = stable ? Json(*stable) : Json();
    if (stable) text += *stable ? "; the closed loop is stable" : "; the closed loop is UNSTABLE";
  } else if (m.encircles) {
    text += "; if it is stable by itself, its closed loop is UNSTABLE: over this band it goes round -1";
  }
  summary["margins"] = json;
  return text + "\n";
}

void add_loop_files(const CommandLine& line, const std::vector<BodeResponse>& responses, OutputSet& out) {
  if (line.has("nyquist-svg")) out.add(line.get<std::string>("nyquist-svg"), nyquist_svg(line, responses));
  if (line.has("nichols-svg")) out.add(line.get<std::string>("nichols-svg"), nichols_svg(line, responses));
  if (line.has("time-response"))
    out.add(line.get<std::string>("time-response"), time_response_csv(line, responses));
}

}  // namespace bodesmith::cli
