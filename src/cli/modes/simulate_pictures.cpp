#include "cli/modes/simulate_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/text.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"

namespace bodesmith::cli {
namespace {

using report::Plot;
using report::Series;

struct Figure {
  std::vector<Plot> plots;
  std::string caption;
};

std::string drawn(const std::string& title, const std::string& subtitle,
                  const std::vector<std::pair<std::string, std::string>>& key,
                  const std::vector<Figure>& figures, const std::string& file) {
  if (std::filesystem::path(file).extension() != ".html") {
    std::vector<Plot> all;
    for (const Figure& figure : figures) all.insert(all.end(), figure.plots.begin(), figure.plots.end());
    return report::stack_svg(all);
  }
  report::Page page(title, subtitle);
  if (!key.empty()) page.key_figures(key);
  for (const Figure& figure : figures) page.plots(figure.plots, figure.caption);
  return page.html();
}

Plot plot(std::string title, report::Axis x, report::Axis y) {
  Plot out;
  out.title = std::move(title);
  out.x = std::move(x);
  out.y = std::move(y);
  return out;
}

Figure over_time(const SimulatedRun& run) {
  Figure out;
  const report::Axis time{"time, s"};
  if (!run.drive.empty()) {
    out.plots = {plot("Reference and output", time, {""}), plot("Tracking error", time, {"r - y"}),
                 plot("Drive", time, {"u"})};
    std::vector<double> error(run.y.size());
    for (std::size_t i = 0; i < error.size(); ++i) error[i] = run.in[i] - run.y[i];
    out.plots[0].series = {{"r", run.time_s, run.in, Series::Style::dashed}, {"y", run.time_s, run.y}};
    out.plots[1].series = {{"", run.time_s, std::move(error), Series::Style::line, 1}};
    out.plots[2].series = {{"", run.time_s, run.drive, Series::Style::line, 2}};
    out.caption = "Reference and output, the tracking error, and the drive.";
    return out;
  }
  out.plots = {plot("Input", time, {"u"}), plot("Output", time, {"y"})};
  out.plots[0].series = {{"", run.time_s, run.in, Series::Style::line, 0}};
  out.plots[1].series = {{run.measured.empty() ? "" : "y", run.time_s, run.y, Series::Style::line, 1}};
  out.caption = "Input and output over time.";
  if (run.measured.empty()) return out;
  out.plots[1].series.push_back({"y measured", run.time_s, run.measured, Series::Style::dashed, 6});
  out.plots.push_back(plot("Error", time, {"y - y measured"}));
  std::vector<double> error(run.y.size());
  for (std::size_t i = 0; i < error.size(); ++i) error[i] = run.y[i] - run.measured[i];
  out.plots[2].series = {{"", run.time_s, std::move(error), Series::Style::line, 3}};
  out.caption = "Input, output with the measured one, and their difference.";
  return out;
}

Series lines_of(const std::string& name, const Spectrum& spectrum, bool marks) {
  // What is only rounding would stretch the axis down to nothing.
  const double floor = 1e-8 * *std::ranges::max_element(spectrum.amplitude);
  Series out{name, {}, {}};
  if (marks) out.style = Series::Style::marks;
  for (std::size_t k = 1; k < spectrum.frequency.size(); ++k) {
    const bool shown = spectrum.amplitude[k] > floor;
    if (marks && (!shown || out.x.size() > 300)) continue;
    out.x.push_back(spectrum.frequency[k].value);
    out.y.push_back(shown ? spectrum.amplitude[k] : NAN);
  }
  return out;
}

Figure spectra(const SimulatedRun& run) {
  const simulate::SignalStudy& study = *run.study;
  const bool periodic = study.repetition.has_value();
  Figure out;
  out.plots = {plot("Spectrum", {"frequency, Hz", true}, {"amplitude", true})};
  out.plots[0].series = {lines_of(run.input, study.u, periodic), lines_of("y", study.y, periodic)};
  if (!periodic) {
    out.caption = "Amplitudes of the whole record, Hann window.";
    return out;
  }
  out.caption =
      fmt::format("Harmonics of {} Hz in the last repetition.", rounded_text(study.fundamental->value));
  if (study.u_distortion_percent && study.y_distortion_percent) {
    out.caption +=
        fmt::format(" Total harmonic distortion: {} {} %, y {} %.", run.input,
                    rounded_text(*study.u_distortion_percent), rounded_text(*study.y_distortion_percent));
  }
  return out;
}

Figure loops(const SimulatedRun& run) {
  const simulate::SignalStudy& study = *run.study;
  Figure out;
  out.plots = {plot("Loop", {run.input}, {"y"})};
  std::size_t from = 0;
  std::size_t to = run.y.size();
  if (study.repetition) {
    const std::size_t length = study.repetition->samples;
    from = (study.loops.size() - 1) * length;
    to = std::min(run.y.size(), from + length + 1);
  }
  const auto cut = [&](const std::vector<double>& x) {
    return std::vector<double>(x.begin() + static_cast<std::ptrdiff_t>(from),
                               x.begin() + static_cast<std::ptrdiff_t>(to));
  };
  out.plots[0].series = {{run.measured.empty() ? "" : "y", cut(run.in), cut(run.y)}};
  if (!run.measured.empty())
    out.plots[0].series.push_back({"y measured", cut(run.in), cut(run.measured), Series::Style::dashed, 6});
  const simulate::Loop& last = study.loops.back();
  out.caption = fmt::format("y over {}, {}. Height {}, {} % of the range.", run.input,
                            study.repetition ? "last repetition" : "whole record", rounded_text(last.height),
                            rounded_text(last.height_percent));
  if (last.u.empty()) {
    out.caption =
        fmt::format("y over {}; there is no loop, {} does not rise and fall.", run.input, run.input);
    return out;
  }
  std::vector<double> gap(last.u.size());
  for (std::size_t i = 0; i < gap.size(); ++i) gap[i] = last.ascending[i] - last.descending[i];
  out.plots.push_back(plot("Ascending minus descending branch", {run.input}, {"difference of y"}));
  out.plots[1].series = {{"", last.u, std::move(gap), Series::Style::line, 1}};
  return out;
}

}  // namespace

std::string picture_of(const SimulatedRun& run, const std::string& file) {
  return drawn(run.title, "simulated", run.figures, {over_time(run), spectra(run), loops(run)}, file);
}

std::string picture_of(const std::vector<simulate::SweepRow>& rows, const std::string& title,
                       const std::string& file) {
  const report::Axis hertz{"frequency, Hz", true};
  Figure figures{{plot("RMS error", hertz, {"% of range"}), plot("Loop height", hertz, {"% of range"})},
                 "y against the input, last period."};
  Figure response{
      {plot("Gain of the fundamental", hertz, {"dB"}), plot("Phase of the fundamental", hertz, {"degrees"}),
       plot("Harmonics 2 to 20", hertz, {"% of the fundamental"})},
      "What becomes of the fundamental."};
  Figure shapes{{plot("Loops", {"input"}, {"y"})}, "The last period of each run."};
  std::vector<double> amplitudes;
  for (const auto& row : rows) {
    if (std::ranges::find(amplitudes, row.amplitude) == amplitudes.end()) amplitudes.push_back(row.amplitude);
  }
  for (const double amplitude : amplitudes) {
    const std::string name = amplitudes.size() > 1 ? "amplitude " + rounded_text(amplitude) : "";
    std::vector<double> f;
    std::vector<double> columns[5];
    for (const auto& row : rows) {
      if (row.amplitude != amplitude) continue;
      f.push_back(row.frequency.value);
      const double values[] = {row.rms_percent, row.loop_height_percent, row.gain_db, row.phase_deg,
                               row.distortion_percent};
      for (int i = 0; i < 5; ++i) columns[i].push_back(values[i]);
    }
    figures.plots[0].series.push_back({name, f, columns[0]});
    figures.plots[1].series.push_back({name, f, columns[1]});
    for (std::size_t i = 0; i < 3; ++i) response.plots[i].series.push_back({name, f, columns[i + 2]});
  }
  for (const auto& row : rows) {
    if (row.u.empty() || shapes.plots[0].series.size() >= 8) continue;
    Series series{fmt::format("{} Hz, {}", rounded_text(row.frequency.value), rounded_text(row.amplitude)),
                  row.u, row.y};
    series.x.push_back(row.u.front());  // closed
    series.y.push_back(row.y.front());
    shapes.plots[0].series.push_back(std::move(series));
  }
  std::vector<Figure> all{figures, response};
  if (!shapes.plots[0].series.empty()) all.push_back(shapes);
  return drawn(title, "simulated over frequency", {}, all, file);
}

}  // namespace bodesmith::cli
