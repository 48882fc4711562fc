#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "gap/diagnosis.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::gap {
namespace {

using report::Plot;
using report::Series;

std::string text_of(double v) {
  return rounded_text(v, 4);
}

/// At most `most` points, keeping the extremes of every stretch so that peaks survive.
void thin(std::vector<double>& x, std::vector<double>& y, std::size_t most) {
  if (x.size() <= most) return;
  const std::size_t cells = most / 2;
  std::vector<double> tx;
  std::vector<double> ty;
  for (std::size_t c = 0; c < cells; ++c) {
    const std::size_t from = c * x.size() / cells;
    const std::size_t to = (c + 1) * x.size() / cells;
    const auto [low, high] = std::minmax_element(y.begin() + static_cast<std::ptrdiff_t>(from),
                                                 y.begin() + static_cast<std::ptrdiff_t>(to));
    auto a = static_cast<std::size_t>(low - y.begin());
    auto b = static_cast<std::size_t>(high - y.begin());
    if (a > b) std::swap(a, b);
    for (std::size_t i : {a, b}) {
      tx.push_back(x[i]);
      ty.push_back(y[i]);
      if (a == b) break;
    }
  }
  x = std::move(tx);
  y = std::move(ty);
}

Series curve(std::string name, std::vector<double> x, std::vector<double> y, int color,
             Series::Style style = Series::Style::line) {
  thin(x, y, 1600);
  Series s;
  s.name = std::move(name);
  s.x = std::move(x);
  s.y = std::move(y);
  s.color = color;
  s.style = style;
  s.width = 1.4;
  return s;
}

/// Spectrum as rms in bands of a twelfth of a decade and wider.
void band_spectrum(const std::vector<double>& e, double step_s, std::vector<double>& hz,
                   std::vector<double>& level) {
  const auto p = periodogram(e, step_s);
  double edge = 0.7 * p.bin_hz;
  std::size_t k = 1;
  while (k < p.power.size()) {
    const double next = std::max(edge * 1.1, edge + p.bin_hz);
    double sum = 0.0;
    int count = 0;
    while (k < p.power.size() && p.bin_hz * static_cast<double>(k) <= next) {
      sum += p.power[k++];
      ++count;
    }
    if (count > 0) {
      hz.push_back(std::sqrt(std::max(edge, p.bin_hz) * next));
      level.push_back(std::sqrt(sum / count / p.bin_hz));
    }
    edge = next;
  }
}

struct Seen {
  const TimeExperiment* experiment = nullptr;
  std::vector<double> time, before, after, e_before, e_after;
};

Seen look(const Diagnosis& d, const TimeExperiment& e) {
  Seen s;
  s.experiment = &e;
  simulate::Options options;
  options.estimate_error = false;
  s.before = simulate::simulate(d.search.base.chain(), e.record(), options).y;
  s.after = simulate::simulate(d.search.final.chain(), e.record(), options).y;
  for (std::size_t i = 0; i < e.record().size(); ++i) {
    s.time.push_back(e.record().time_s(i));
    s.e_before.push_back(e.record().y[i] - s.before[i]);
    s.e_after.push_back(e.record().y[i] - s.after[i]);
  }
  return s;
}

std::vector<double> slice(const std::vector<double>& v, std::size_t from, std::size_t to) {
  return {v.begin() + static_cast<std::ptrdiff_t>(from), v.begin() + static_cast<std::ptrdiff_t>(to)};
}

void time_figures(report::Page& page, const Seen& s) {
  const auto& record = s.experiment->record();
  const std::size_t n = record.size();
  // The stretch of a twenty-fifth of the record where the base model is worst.
  const std::size_t width = std::clamp<std::size_t>(n / 25, std::min<std::size_t>(n, 60), n);
  std::size_t best = s.experiment->skip();
  double most = -1.0;
  double sum = 0.0;
  for (std::size_t i = s.experiment->skip(); i < n; ++i) {
    sum += s.e_before[i] * s.e_before[i];
    if (i >= s.experiment->skip() + width) sum -= s.e_before[i - width] * s.e_before[i - width];
    if (i + 1 >= s.experiment->skip() + width && sum > most) {
      most = sum;
      best = i + 1 - width;
    }
  }
  Plot zoom;
  zoom.title = "Where the base model is worst";
  zoom.x.label = "time, s";
  zoom.y.label = "output y";
  const auto t = slice(s.time, best, best + width);
  zoom.series = {curve("measured", t, slice(record.y, best, best + width), 0),
                 curve("base model", t, slice(s.before, best, best + width), 1, Series::Style::dashed),
                 curve("extended model", t, slice(s.after, best, best + width), 2)};
  Plot residual;
  residual.title = "Measured minus model";
  residual.x.label = "time, s";
  residual.y.label = "residual";
  residual.height = 240;
  const std::size_t from = s.experiment->skip();  // a start transient would dwarf the rest
  residual.series = {curve("base model", slice(s.time, from, n), slice(s.e_before, from, n), 1),
                     curve("extended model", slice(s.time, from, n), slice(s.e_after, from, n), 2)};
  page.figure(report::stack_svg({zoom, residual}),
              fmt::format("Held-out record {}: output and residual, before and after.", record.file));

  std::vector<double> u(record.u.begin() + static_cast<std::ptrdiff_t>(s.experiment->skip()), record.u.end());
  Plot loops;
  loops.title = "Residual over the input";
  loops.x.label = "input u";
  loops.y.label = "measured minus model";
  const auto loop = [&](const char* name, const std::vector<double>& e, int color) {
    Series series;
    series.name = name;
    series.color = color;
    series.width = 0.8;
    const std::size_t to = std::min(n, from + 3000);
    series.x = slice(record.u, from, to);
    series.y = slice(e, from, to);
    return series;
  };
  loops.series = {loop("base model", s.e_before, 1), loop("extended model", s.e_after, 2)};
  page.figure(report::to_svg(loops),
              "Loops: memory opens them, a static curve bends them, noise fills a band.");
}

void spectrum_figure(report::Page& page, const Seen& s, const NoiseFloor& floor) {
  Plot plot;
  plot.title = "Spectrum of the residual";
  plot.x.label = "frequency, Hz";
  plot.x.logarithmic = true;
  plot.y.label = "per root hertz";
  plot.y.logarithmic = true;
  const std::size_t from = s.experiment->skip();
  const auto step = s.experiment->record().step_s;
  const auto add = [&](const char* name, const std::vector<double>& e, int color) {
    Series series;
    series.name = name;
    series.color = color;
    band_spectrum(slice(e, from, e.size()), step, series.x, series.y);
    for (double& v : series.y) v = std::max(v, 1e-300);
    plot.series.push_back(std::move(series));
  };
  add("base model", s.e_before, 1);
  add("extended model", s.e_after, 2);
  if (floor.how != NoiseFloor::How::unknown && floor.rms > 0.0) {
    Series line;
    line.name = "noise floor, were it white";
    line.color = 3;
    line.style = Series::Style::dashed;
    const double level = floor.rms / std::sqrt(0.5 / step);
    line.x = {plot.series[0].x.front(), plot.series[0].x.back()};
    line.y = {level, level};
    plot.series.push_back(line);
  }
  page.figure(report::to_svg(plot), "Before and after, held-out record.");
}

void response_figures(report::Page& page, const Diagnosis& d, const FrequencyExperiment& e) {
  Plot magnitude;
  Plot phase;
  magnitude.title = "Frequency response";
  magnitude.x.label = phase.x.label = "frequency, Hz";
  magnitude.x.logarithmic = phase.x.logarithmic = true;
  magnitude.y.label = "magnitude, dB";
  phase.y.label = "phase, degrees";
  phase.height = 240;
  const auto add = [&](const char* name, int color, Series::Style style,
                       const std::vector<std::complex<double>>& h) {
    Series m;
    Series p;
    m.name = p.name = name;
    m.color = p.color = color;
    m.style = p.style = style;
    double last = 0.0;
    for (std::size_t i = 0; i < h.size(); ++i) {
      const double hz = e.record().frequency[i].value;
      double angle = to_degrees(std::arg(h[i]));
      while (i > 0 && angle - last > 180.0) angle -= 360.0;
      while (i > 0 && angle - last < -180.0) angle += 360.0;
      last = angle;
      m.x.push_back(hz);
      p.x.push_back(hz);
      m.y.push_back(to_decibel(std::abs(h[i])));
      p.y.push_back(angle);
    }
    magnitude.series.push_back(m);
    phase.series.push_back(p);
  };
  const auto response = [&](const Model& model) {
    std::vector<std::complex<double>> h;
    const auto chain = model.chain();
    for (const auto& f : e.record().frequency) h.push_back(chain.response(f.rad_s()).value_or(0.0));
    return h;
  };
  add("measured", 0, Series::Style::marks, e.record().response);
  add("base model", 1, Series::Style::dashed, response(d.search.base));
  add("extended model", 2, Series::Style::line, response(d.search.final));
  page.figure(report::stack_svg({magnitude, phase}), fmt::format("Held-out response {}.", e.record().file));
}

std::string sentence(const Diagnosis& d) {
  switch (d.verdict) {
    case Verdict::explained:
      return "What was missing has been found: nothing but noise seems to be left.";
    case Verdict::partly_explained:
      return "Part of what was missing has been found, and more is left that the catalogue does not explain.";
    case Verdict::nothing_missing:
      return "Nothing is missing that these records can show: what the model leaves is noise.";
    case Verdict::unexplained:
      break;
  }
  return "Something is missing, and no effect of the catalogue explains it. No name is given rather than a "
         "wrong one.";
}

report::Table cells_table(const std::vector<Cell>& cells) {
  report::Table t;
  t.head = {"axis", "from", "to", "share of the gap", "share of the record"};
  for (const auto& c : cells) {
    t.rows.push_back({c.axis, text_of(c.from), text_of(c.to), fmt::format("{:.1f} %", 100.0 * c.share),
                      fmt::format("{:.1f} %", 100.0 * c.extent)});
  }
  return t;
}

report::Table ranking_table(const std::vector<Ranked>& ranking) {
  report::Table t;
  t.head = {"effect",       "placed",       "unknowns",     "foreseen",
            "training rms", "held-out rms", "significance", "outcome"};
  for (const auto& r : ranking) {
    if (r.effect == nullptr) continue;
    if (r.word == "named") t.marked.push_back(t.rows.size());
    t.rows.push_back({std::string(r.effect->name()), r.placed, std::to_string(r.unknowns),
                      fmt::format("{:.1f} %", 100.0 * r.score), text_of(r.train_rms), text_of(r.holdout_rms),
                      fmt::format("{:.1f}", std::min(r.z, 9999.0)), r.word});
  }
  return t;
}

}  // namespace

std::string report_page(const Diagnosis& d, const Study& study) {
  std::string named;
  for (const auto& s : d.steps) named += (named.empty() ? "" : ", ") + s.effect;
  report::Page page("What the model is missing",
                    named.empty() ? word(d.verdict) : fmt::format("{}: {}", word(d.verdict), named));
  page.chapter("Verdict");
  page.paragraph(sentence(d));
  const double closed =
      d.refitted.holdout_rms > 0.0 ? 100.0 * (1.0 - d.final.holdout_rms / d.refitted.holdout_rms) : 0.0;
  page.key_figures({{word(d.verdict), "verdict"},
                    {text_of(d.refitted.holdout_rms), "held-out rms, base model refitted"},
                    {text_of(d.final.holdout_rms), "held-out rms, extended model"},
                    {fmt::format("{:.1f} %", closed), "of the held-out rms removed"},
                    {d.floor.how == NoiseFloor::How::unknown ? "unknown" : text_of(d.floor.rms),
                     "noise floor (" + d.floor.word() + ")"}});
  for (const auto& s : d.steps) {
    std::string text =
        fmt::format("{} ({}): {}.", s.effect, s.placed, std::string(find_effect(s.effect)->what()));
    std::vector<std::string> values;
    for (const auto& p : s.parameters)
      values.push_back(
          fmt::format("{} = {} ({} to {})", p.name, text_of(p.value), text_of(p.low), text_of(p.high)));
    text += " " + join(values, ", ") + ".";
    if (!s.tied_with.empty())
      text += fmt::format(" These records cannot tell it from {}.", join(s.tied_with, ", "));
    page.paragraph(text);
  }
  if (!d.advice.empty()) page.warning(d.advice);

  page.chapter("The gap, step by step");
  report::Table steps;
  steps.head = {"model", "training rms", "held-out rms", "held-out, % of range", "runner-up (held-out rms)"};
  steps.rows.push_back({"as given", text_of(d.initial.train_rms), text_of(d.initial.holdout_rms),
                        fmt::format("{:.3f}", d.initial.holdout_percent_of_range), ""});
  steps.rows.push_back({"free parameters refitted", text_of(d.refitted.train_rms),
                        text_of(d.refitted.holdout_rms),
                        fmt::format("{:.3f}", d.refitted.holdout_percent_of_range), ""});
  Series train;
  Series holdout;
  train.name = "training";
  holdout.name = "held-out";
  const auto mark = [&](double x, const GapSize& g) {
    train.x.push_back(x);
    holdout.x.push_back(x);
    train.y.push_back(std::max(g.train_rms, 1e-300));
    holdout.y.push_back(std::max(g.holdout_rms, 1e-300));
  };
  mark(0, d.refitted);
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    const auto& s = d.steps[k];
    const std::string rival =
        s.runner_up.empty() ? "" : fmt::format("{} ({})", s.runner_up, text_of(s.runner_up_holdout_rms));
    steps.rows.push_back(
        {"+ " + s.effect + (s.tied_with.empty() ? "" : " (or " + join(s.tied_with, ", ") + ")"),
         text_of(s.after.train_rms), text_of(s.after.holdout_rms),
         fmt::format("{:.3f}", s.after.holdout_percent_of_range), rival});
    mark(static_cast<double>(k + 1), s.after);
  }
  page.table(steps, "Each figure is what `bodesmith simulate` finds with the model of that row.");
  if (!d.steps.empty()) {
    Plot ladder;
    ladder.title = "Gap after each step";
    ladder.x.label = "terms added";
    ladder.y.label = "rms of the residual";
    ladder.y.logarithmic = true;
    ladder.height = 260;
    ladder.series = {train, holdout};
    if (d.floor.how == NoiseFloor::How::periods && d.floor.rms > 0.0) {
      Series line;
      line.name = "noise floor";
      line.style = Series::Style::dashed;
      line.x = {0.0, static_cast<double>(d.steps.size())};
      line.y = {d.floor.rms, d.floor.rms};
      ladder.series.push_back(line);
    }
    page.figure(report::to_svg(ladder), "Training and held-out records.");
  }

  page.chapter("Where the gap lies");
  page.table(cells_table(d.where), "The model as given: where the gap is densest on each axis.");
  page.table(cells_table(d.remaining_where), "The extended model: where what remains is densest.");
  if (d.floor.how == NoiseFloor::How::periods) {
    page.paragraph(fmt::format(
        "From {} periods: noise {} rms; what repeats of the final residual is {} in odd and {} in even "
        "harmonics.",
        d.floor.periods, text_of(d.floor.rms), text_of(d.floor.odd_rms), text_of(d.floor.even_rms)));
  }

  page.chapter("Before and after");
  for (const auto* e : study.holdout()) {
    if (const auto* time = dynamic_cast<const TimeExperiment*>(e)) {
      const auto seen = look(d, *time);
      time_figures(page, seen);
      spectrum_figure(page, seen, d.floor);
    } else if (const auto* response = dynamic_cast<const FrequencyExperiment*>(e)) {
      response_figures(page, d, *response);
    }
  }

  page.chapter("The candidates");
  for (std::size_t k = 0; k < d.search.steps.size(); ++k) {
    page.table(ranking_table(d.search.steps[k].ranking),
               fmt::format("Round {}: {} was named.", k + 1, d.search.steps[k].effect->name()));
  }
  if (!d.search.refused.empty())
    page.table(ranking_table(d.search.refused), "Last round: none earned its place.");
  for (const auto& s : d.search.structure)
    page.paragraph(fmt::format("Sign of more: {} ({:.1f} times what chance reaches).", s.what, s.strength));

  page.chapter("The extended model");
  page.listing(chain::model_text(d.search.final.chain()));
  return page.html();
}

}  // namespace bodesmith::gap
