#include <fmt/format.h>

#include <algorithm>

#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "project/run.hpp"
#include "project/tracking/engines.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"

namespace bodesmith::project {
report::Table tracking_table(const TrackingStudy& study) {
  report::Table table;
  table.head = {"compensation"};
  for (const Hertz f : study.frequency) table.head.push_back(rounded_text(f.value) + " Hz");
  for (const TrackedDesign& design : study.designs) {
    if (design.built) table.marked.push_back(table.rows.size());
    table.rows.push_back({design.name});
    for (const tracking::TrackingError& one : design.at)
      table.rows.back().push_back(fmt::format("{:.3f}", one.rms_percent));
  }
  return table;
}

namespace {

/// Of twenty curves those that a reader looks for first: nothing, the polynomial, the disturbance paper's design, the ideal
/// and what stands for the run. The others are switched on in the page.
bool is_shown_first(const TrackingStudy& study, const TrackedDesign& design) {
  return design.key == tracked::none || design.key == tracked::polynomial || design.key == tracked::cascade ||
         design.key == tracked::self_fed_slope || design.key == study.as_built;
}

report::Plot tracking_plot(const TrackingStudy& study) {
  report::Plot plot;
  plot.title = "rms tracking error over the operating frequency";
  plot.x = {"frequency, Hz", true};
  plot.y = {"% of range", true};
  for (const TrackedDesign& design : study.designs) {
    plot.series.push_back(
        {design.name, hertz_values(study.frequency), design.each(&tracking::TrackingError::rms_percent)});
    plot.series.back().shown = is_shown_first(study, design);
  }
  return plot;
}

/// Reference and errors over one period, below one another.
std::vector<report::Plot> period_plots(const TrackingStudy& study) {
  using report::Series;
  report::Plot reference;
  reference.title = fmt::format("One period at {} Hz", rounded_text(study.shown.frequency.value));
  reference.x = {"time, s"};
  reference.y = {"reference"};
  reference.height = 200;
  reference.series.push_back(
      {"reference x", study.shown.time_s, study.shown.reference, Series::Style::line, 6});
  report::Plot error;
  error.title = "Tracking error";
  error.x = {"time, s"};
  error.y = {"% of range"};
  for (std::size_t i = 0; i < study.shown.error_percent.size(); ++i) {
    if (study.designs[i].key == tracked::none) continue;
    error.series.push_back({study.designs[i].name, study.shown.time_s, study.shown.error_percent[i],
                            Series::Style::line, static_cast<int>(i)});
    error.series.back().shown = is_shown_first(study, study.designs[i]);
  }
  return {reference, error};
}

report::Table elsewhere_table(const TrackingStudy& study) {
  report::Table table;
  table.head = {"stage", "reference", "amplitude", "model's own fit"};
  for (const TrackedDesign& design : study.elsewhere.front().designs) table.head.push_back(design.name);
  for (const TrackedElsewhere& one : study.elsewhere) {
    const std::string fit = one.fit_percent.empty()
                                ? std::string()
                                : fmt::format("{:.3f}", *std::ranges::max_element(one.fit_percent));
    table.rows.push_back({one.stage, std::string(to_string(one.waveform)), rounded_text(one.amplitude), fit});
    for (const TrackedDesign& design : one.designs)
      table.rows.back().push_back(fmt::format("{:.3f}", design.worst_without_lag_percent()));
  }
  return table;
}

}  // namespace

void tracking_chapter(report::Page& page, const Run& run) {
  if (!run.project.plant) return;
  page.chapter("Tracking");
  page.paragraph(fmt::format(
      "A {} of {} of the full stroke ({} um) through disturbance generator, compensator, amplifier and a stage that reads "
      "its drive, y = v + K(f) d(v), integrated by CVODE until it repeats; rms error in percent of the range (eq. 8), as "
      "in the paper's Table II. The largest difference from the harmonic computation is {} % of range.",
      to_string(run.tracking.waveform), rounded_text(run.tracking.amplitude),
      rounded_text(run.project.plant->stroke_m * 1e6),
      rounded_text(run.tracking.max_cross_check_percent, 2)));
  page.table(tracking_table(run.tracking), "rms tracking error, % of range (marked: of what is built)");
  if (!run.tracking.engines.empty()) {
    page.table(
        engine_table(run.tracking.engines),
        "what is built, by every engine: worst rms error over the frequencies, pure delay removed, and the "
        "greatest rms difference between two of them, % of range");
    for (const EngineRow& one : run.tracking.engines)
      if (!one.missing.empty()) page.paragraph(one.what + ": " + one.missing + ".");
  }
  page.plots({tracking_plot(run.tracking)},
             "The tracking error of every way of compensating over the frequency.");
  page.plots(period_plots(run.tracking),
             "The error without any compensation is left out: it would dwarf the others.");
  if (run.tracking.elsewhere.empty()) return;
  page.paragraph(
      "A stage is not its polynomial: the same controllers on stages of other families that were identified from the "
      "polynomials' loops, and along the other references. What a controller leaves there can be as good as the model's "
      "own fit to the loops, not better.");
  page.table(elsewhere_table(run.tracking),
             "worst rms tracking error over the frequencies, % of range, pure delay removed");
}

}  // namespace bodesmith::project
