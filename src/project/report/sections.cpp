#include <fmt/format.h>

#include <cmath>

#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
namespace {

std::string settled_text(double percent) {
  return std::isfinite(percent) ? fmt::format("{:.3f}", percent) : "does not settle";
}

}  // namespace

report::Table alternatives_table(const Design& design) {
  report::Table table{
      {"alternative", "poles", "error at the points, dB", "phase there, degrees", "above the band, dB",
       "waveform rms, %", "worst frequency, %", "tracked self-fed, %", "FPAA blocks"},
      {},
      {design.chosen}};
  for (const Alternative& a : design.alternatives) {
    table.rows.push_back({a.name, std::to_string(a.sections.pole_count()), rounded_text(a.points_max_db, 3),
                          rounded_text(a.phase_at_points_deg, 3), fmt::format("{:.2f}", a.above_band_db),
                          fmt::format("{:.3f}", a.waveform.rms_percent),
                          fmt::format("{:.3f}", a.waveform.worst_percent), settled_text(a.tracked_percent),
                          std::to_string(a.fpaa_blocks)});
  }
  return table;
}

namespace {

/// Every second point of the stages that can be told apart, so that seven alternatives stay a small part of the page.
std::vector<report::Plot> response_plots(const Run& run, const AlternativeStudy& study) {
  std::vector<report::Plot> out = stages_plots(run.project, study.design);
  for (report::Plot& plot : out) {
    std::erase_if(plot.series,
                  [](const report::Series& one) { return one.name == "fpaa" || one.name == "circuit"; });
    for (report::Series& series : plot.series) {
      if (series.style == report::Series::Style::marks) continue;
      report::Series half = series;
      half.x.clear();
      half.y.clear();
      for (std::size_t i = 0; i < series.x.size(); i += 2) {
        half.x.push_back(series.x[i]);
        half.y.push_back(series.y[i]);
      }
      series = std::move(half);
    }
  }
  return out;
}

/// The alternative next to the one that is built.
report::Plot tracked_plot(const Run& run, std::size_t index) {
  report::Plot out;
  out.title = "Tracking error, fed by its own drive, pure delay removed";
  out.x = {"frequency, Hz", true};
  out.y = {"% of range", true};
  out.height = 240;
  const auto add = [&](const std::string& name, const Alternative& one, int colour) {
    out.series.push_back({name, hertz_values(run.tracking.frequency), one.tracked_at_percent,
                          report::Series::Style::line, colour});
  };
  add("this alternative", run.design.alternatives[index], 0);
  add("the one that is built", run.design.built(), 6);
  out.series.back().style = report::Series::Style::dashed;
  return out;
}

report::Table tracked_table(const Run& run, const Alternative& alternative) {
  report::Table table{{"frequency, Hz", "tracking rms, %", "waveform rms, %"}, {}, {}};
  for (std::size_t i = 0; i < run.tracking.frequency.size(); ++i) {
    table.rows.push_back({rounded_text(run.tracking.frequency[i].value),
                          settled_text(alternative.tracked_at_percent[i]),
                          fmt::format("{:.3f}", alternative.waveform.points[i].rms_percent)});
  }
  return table;
}

report::Choice choice_of(const Run& run, std::size_t index) {
  const Alternative& alternative = run.design.alternatives[index];
  const AlternativeStudy& study = run.alternatives[index];
  report::Choice out;
  out.name = alternative.name + (index == run.design.chosen ? " (built)" : "");
  out.figures = {
      {rounded_text(alternative.points_max_db, 3) + " dB", "largest error at the points"},
      {std::isfinite(alternative.tracked_percent) ? rounded_text(alternative.tracked_percent, 3) + " %"
                                                  : std::string("does not settle"),
       "worst tracking error fed by its own drive, pure delay removed"}};
  out.plots = response_plots(run, study);
  out.plots.push_back(tracked_plot(run, index));
  out.notes = study.refused;
  out.tables = {
      {budget_table(study.budget), "Error budget"},
      {tracked_table(run, alternative), "Tracking in percent of the range"},
      {sections_table(alternative.sections), "Sections: " + sections_caption(alternative.sections)}};
  if (study.design.plan) {
    const fpaa::Plan& plan = *study.design.plan;
    out.figures.emplace_back(rounded_text(plan.error_with_delays.max_complex_percent, 3) + " %",
                             fmt::format("on the FPAA as it runs, {} CAMs{}", plan.cams().size(),
                                         index == run.design.chosen ? "" : ", by a quick search"));
    out.tables.emplace_back(cams_table(plan), "On the FPAA");
  }
  if (study.design.circuit) {
    const synthesis::Realised& made = study.design.realised();
    out.figures.emplace_back(
        rounded_text(made.report.all.max_magnitude_db, 3) + " dB",
        fmt::format("in parts, {} op-amps, {} parts", made.circuit.opamps.size(), made.circuit.parts.size()));
    out.tables.emplace_back(parts_table(made.circuit.parts), "Parts");
  }
  return out;
}

/// The table of the alternatives; of the chosen one its response, error budget, tracking, sections and parts.
void add_alternatives(report::Page& page, const Run& run) {
  std::vector<report::Choice> choices;
  for (std::size_t i = 0; i < run.alternatives.size(); ++i) choices.push_back(choice_of(run, i));
  page.choices(
      alternatives_table(run.design),
      "Alternatives (marked: the one that is built). Direct and waveform fits have real poles and zeros. "
      "Waveform: error of the compensating waveform at the tracked frequencies, % of range; tracked: worst error of a "
      "generator fed by its own drive, pure delay removed. Choose a row to see what it "
      "becomes; on the board by a quick search where it is not built (bodesmith fpaa searches longer).",
      choices, run.design.chosen);
}

report::Table approximated_terms_table(const CascadeApproximation& approximation) {
  report::Table table{
      {"term", "beta", "corner ratio", "order", "error everywhere, dB", "limit of any method, dB"}, {}, {}};
  for (const TermApproximation& term : approximation.terms) {
    table.rows.push_back({fmt::format("{} - {} Hz", rounded_text(term.term.low_corner().hz().value),
                                      rounded_text(term.term.high_corner().hz().value)),
                          fmt::format("{:+.4f}", term.term.beta), rounded_text(term.term.corner_ratio()),
                          std::to_string(term.order), rounded_text(term.error.everywhere_db, 3),
                          term.limit_law_db > 0.0 ? rounded_text(term.limit_law_db, 3) : "-"});
  }
  return table;
}

}  // namespace

void sections_chapter(report::Page& page, const Run& run) {
  page.chapter("Sections");
  if (const auto& a = run.design.approximation) {
    page.paragraph(fmt::format(
        "The cascade approximated by the method {}: {} poles in all. Largest error {} dB over all frequencies, {} dB "
        "and {} degrees between {} and {} Hz.",
        a->method, a->sections.pole_count(), rounded_text(a->error.everywhere_db, 3),
        rounded_text(a->error.band_db, 3), rounded_text(a->error.band_deg, 3),
        rounded_text(a->error.band.from.value), rounded_text(a->error.band.to.value)));
    if (!a->limit_met()) page.warning("The error limit could not be met at the largest order.");
    page.table(approximated_terms_table(*a));
  }
  if (run.project.plant) add_alternatives(page, run);
  for (const std::string& reason : run.design.passed_over)
    page.paragraph("Passed over because it cannot be built: " + reason);
  page.table(sections_table(run.design.sections()), sections_caption(run.design.sections()));
}

}  // namespace bodesmith::project
