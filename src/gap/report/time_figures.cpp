#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "gap/report/figures.hpp"
#include "gap/report/where.hpp"
#include "report/plot.hpp"
#include "report/script_data.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

using report::Plot;
using report::Series;

/// Colours of the palette.
enum Colour { kMeasured, kBase, kExtended, kFloor };

std::vector<double> slice(const std::vector<double>& v, std::size_t from, std::size_t to) {
  const auto part = std::span(v).subspan(from, to - from);
  return {part.begin(), part.end()};
}

Series series_of(std::string name, int color) {
  Series s;
  s.name = std::move(name);
  s.color = color;
  return s;
}

/// A held-out record next to what the models make of it.
struct BeforeAndAfter {
  const TimeRecord& record;
  std::size_t first;  ///< scored sample; a start transient would dwarf the rest
  std::vector<double> time, before, after, residual_before, residual_after;
};

BeforeAndAfter simulate_both(const Diagnosis& d, const TimeExperiment& e) {
  BeforeAndAfter s{e.record(), e.first(), e.record().times_s(), {}, {}, {}, {}};
  s.residual_before = whole_residual(d.search.base, e);
  s.residual_after = whole_residual(d.search.final, e);
  for (std::size_t i = 0; i < e.record().size(); ++i) {
    s.before.push_back(e.record().y[i] - s.residual_before[i]);
    s.after.push_back(e.record().y[i] - s.residual_after[i]);
  }
  return s;
}

/// First sample of the stretch of `width` samples where the base model is worst.
std::size_t worst_stretch(const BeforeAndAfter& s, std::size_t width) {
  const auto energy_at = [&](std::size_t from) {
    return rms(std::span(s.residual_before).subspan(from, width));
  };
  std::size_t worst = s.first;
  for (std::size_t from = worst; from + width <= s.record.size(); from += width) {
    if (energy_at(from) > energy_at(worst)) worst = from;
  }
  return worst;
}

Series curve(std::string name, const std::vector<double>& x, const std::vector<double>& y, std::size_t from,
             std::size_t to, int color) {
  Series c = series_of(std::move(name), color);
  c.x = slice(x, from, to);
  c.y = slice(y, from, to);
  c.width = 1.4;
  return c;
}

Plot plot_of(const char* title, const char* x, const char* y, std::vector<Series> series) {
  Plot plot;
  plot.title = title;
  plot.x.label = x;
  plot.y.label = y;
  plot.series = std::move(series);
  return plot;
}

/// What both models leave over some signal.
Plot residuals_over(const BeforeAndAfter& s, const std::vector<double>& x, std::size_t to, const char* title,
                    const char* label) {
  return plot_of(title, label, "measured minus model",
                 {curve("base model", x, s.residual_before, s.first, to, kBase),
                  curve("extended model", x, s.residual_after, s.first, to, kExtended)});
}

Plot zoomed_output(const BeforeAndAfter& s) {
  const std::size_t width = (s.record.size() - s.first) / kBins;
  const std::size_t from = worst_stretch(s, width);
  const std::size_t to = from + width;
  Plot plot = plot_of("Where the base model is worst", "time, s", "output y",
                      {curve("measured", s.time, s.record.y, from, to, kMeasured),
                       curve("base model", s.time, s.before, from, to, kBase),
                       curve("extended model", s.time, s.after, from, to, kExtended)});
  plot.series[1].style = Series::Style::dashed;
  return plot;
}

Plot residual_over_input(const BeforeAndAfter& s) {
  const std::size_t to = std::min(s.record.size(), s.first + report::kMostLivePoints);
  Plot plot = residuals_over(s, s.record.u, to, "Residual over the input", "input u");
  for (Series& one : plot.series) one.width = 0.8;
  return plot;
}

/// Spectrum as rms per root hertz, without the constant.
Series band_spectrum(std::string name, const std::vector<double>& e, double step_s, int color) {
  Series series = series_of(std::move(name), color);
  for (const Bin& band : frequency_bins(e, step_s)) {
    if (!(band.from > 0.0)) continue;
    series.x.push_back(std::sqrt(band.from * band.to));
    series.y.push_back(std::max(std::sqrt(band.energy / band.extent), 1e-300));
  }
  return series;
}

Plot residual_spectrum(const BeforeAndAfter& s, const NoiseFloor& floor) {
  const std::size_t n = s.record.size();
  const double step_s = s.record.step_s;
  Plot plot =
      plot_of("Spectrum of the residual", "frequency, Hz", "per root hertz",
              {band_spectrum("base model", slice(s.residual_before, s.first, n), step_s, kBase),
               band_spectrum("extended model", slice(s.residual_after, s.first, n), step_s, kExtended)});
  plot.x.logarithmic = plot.y.logarithmic = true;
  if (floor.source != NoiseFloor::Source::unknown && floor.rms > 0.0) {
    Series line = series_of("noise floor, were it white", kFloor);
    line.style = Series::Style::dashed;
    const double level = floor.rms / std::sqrt(0.5 / step_s);
    line.x = {plot.series[0].x.front(), plot.series[0].x.back()};
    line.y = {level, level};
    plot.series.push_back(line);
  }
  return plot;
}

}  // namespace

void add_record_figures(report::Page& page, const Diagnosis& d, const TimeExperiment& experiment) {
  const auto s = simulate_both(d, experiment);
  page.plots(
      {zoomed_output(s), residuals_over(s, s.time, s.record.size(), "Measured minus model", "time, s")},
      fmt::format("Held-out record {}: output and residual, before and after.", s.record.file));
  page.plots({residual_over_input(s)},
             "Loops: memory opens them, a static curve bends them, noise fills a band.");
  page.plots({residual_spectrum(s, d.floor)}, "Before and after, held-out record.");
}

}  // namespace bodesmith::gap
