#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "gap/report/figures.hpp"
#include "report/bars.hpp"
#include "report/plot.hpp"

namespace bodesmith::gap {
namespace {

using Responses = std::vector<std::complex<double>>;

/// Degrees, without jumps of a turn.
std::vector<double> unwrapped_phase(const Responses& h) {
  std::vector<double> phase;
  for (const auto& value : h) {
    const double angle = to_degrees(std::arg(value));
    const double last = phase.empty() ? angle : phase.back();
    phase.push_back(last + std::remainder(angle - last, 360.0));
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
  const double scale = d.relative ? 100.0 : 1.0;
  report::Bars ladder;
  ladder.title = "Gap after each step";
  ladder.axis = d.relative ? "rms of H_model/H_measured - 1, %" : "rms of the residual";
  ladder.names = {"training", "held-out"};
  const auto add = [&](std::string label, const GapSize& size) {
    report::Bars::Group group{std::move(label), {}, {}};
    for (const double rms : {size.train_rms, size.holdout_rms}) {
      group.values.push_back(scale * rms);
      group.texts.push_back(figure_text(scale * rms));
    }
    ladder.groups.push_back(std::move(group));
  };
  add("base model refitted", d.refitted);
  for (const DiagnosedStep& step : d.steps) add("+ " + step.effect, step.after);
  if (d.floor.source == NoiseFloor::Source::periods && d.floor.rms > 0.0) {
    ladder.line = d.floor.rms;
    ladder.line_name = "noise floor";
  }
  page.figure(report::to_svg(ladder), "Training and held-out records.");
}

}  // namespace bodesmith::gap
