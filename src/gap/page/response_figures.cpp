#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "gap/page/figures.hpp"
#include "report/bode.hpp"

namespace bodesmith::gap {
namespace {

using Responses = std::vector<std::complex<double>>;

/// Degrees, without jumps of a turn.
std::vector<double> unwrapped_phase(const Responses& h) {
  std::vector<double> phase;
  for (const auto& value : h) {
    double angle = to_degrees(std::arg(value));
    while (!phase.empty() && angle - phase.back() > 180.0) angle -= 360.0;
    while (!phase.empty() && angle - phase.back() < -180.0) angle += 360.0;
    phase.push_back(angle);
  }
  return phase;
}

Responses response_of(const Model& model, const FrequencyRecord& record) {
  Responses h;
  const auto chain = model.chain();
  for (const auto& f : record.frequency) h.push_back(chain.response(f.rad_s()).value_or(0.0));
  return h;
}

void add_response(report::BodePlot& plot, const char* name, int color, report::Series::Style style,
                  const FrequencyRecord& record, const Responses& h) {
  report::Series magnitude;
  magnitude.name = name;
  magnitude.color = color;
  magnitude.style = style;
  for (const auto& f : record.frequency) magnitude.x.push_back(f.value);
  report::Series phase = magnitude;
  for (const auto& value : h) magnitude.y.push_back(to_decibel(std::abs(value)));
  phase.y = unwrapped_phase(h);
  plot.magnitude.series.push_back(std::move(magnitude));
  plot.phase.series.push_back(std::move(phase));
}

}  // namespace

void add_record_figures(report::Page& page, const Diagnosis& d, const FrequencyExperiment& experiment) {
  using Style = report::Series::Style;
  const auto& record = experiment.record();
  report::BodePlot plot;
  add_response(plot, "measured", 0, Style::marks, record, record.response);
  add_response(plot, "base model", 1, Style::dashed, record, response_of(d.search.base, record));
  add_response(plot, "extended model", 2, Style::line, record, response_of(d.search.final, record));
  page.plots(plot.plots(), fmt::format("Held-out response {}.", record.file));
}

void add_ladder_figure(report::Page& page, const Diagnosis& d) {
  report::Series train;
  report::Series holdout;
  train.name = "training";
  holdout.name = "held-out";
  const auto mark = [&](const GapSize& size) {
    const auto terms = static_cast<double>(train.x.size());
    train.x.push_back(terms);
    holdout.x.push_back(terms);
    const double scale = d.relative ? 100.0 : 1.0;
    train.y.push_back(std::max(scale * size.train_rms, 1e-300));
    holdout.y.push_back(std::max(scale * size.holdout_rms, 1e-300));
  };
  mark(d.refitted);
  for (const auto& s : d.steps) mark(s.after);
  report::Plot ladder;
  ladder.title = "Gap after each step";
  ladder.x.label = "terms added";
  ladder.y.label = d.relative ? "rms of H_model/H_measured - 1, %" : "rms of the residual";
  ladder.y.logarithmic = true;
  ladder.height = 260;
  ladder.series = {train, holdout};
  if (d.floor.source == NoiseFloor::Source::periods && d.floor.rms > 0.0) {
    report::Series line;
    line.name = "noise floor";
    line.style = report::Series::Style::dashed;
    line.x = {0.0, static_cast<double>(d.steps.size())};
    line.y = {d.floor.rms, d.floor.rms};
    ladder.series.push_back(std::move(line));
  }
  page.plots({ladder}, "Training and held-out records.");
}

}  // namespace bodesmith::gap
