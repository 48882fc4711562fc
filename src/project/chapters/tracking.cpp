#include <fmt/format.h>

#include "base/text.hpp"
#include "project/run.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"

namespace bodesmith::project {
namespace {

report::Table tracking_table(const TrackingStudy& study) {
  report::Table table;
  table.head = {"compensation"};
  for (const Hertz f : study.frequency) table.head.push_back(rounded_text(f.value) + " Hz");
  for (const TrackedDesign& design : study.designs) {
    table.rows.push_back({design.name});
    for (const double value : design.rms_percent) table.rows.back().push_back(fmt::format("{:.3f}", value));
  }
  return table;
}

report::Plot tracking_plot(const TrackingStudy& study) {
  report::Plot plot;
  plot.title = "rms tracking error over the operating frequency";
  plot.x = {"frequency, Hz", true};
  plot.y = {"% of range", true};
  std::vector<double> hertz;
  for (const Hertz f : study.frequency) hertz.push_back(f.value);
  for (const TrackedDesign& design : study.designs)
    plot.series.push_back({design.name, hertz, design.rms_percent});
  return plot;
}

/// Reference and errors over one period, below one another.
std::string period_svg(const TrackingStudy& study) {
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
    if (study.designs[i].stage == TrackedStage::none) continue;
    error.series.push_back({study.designs[i].name, study.shown.time_s, study.shown.error_percent[i],
                            Series::Style::line, static_cast<int>(i)});
  }
  return report::stack_svg({reference, error});
}

}  // namespace

void tracking_chapter(report::Page& page, const ProjectRun& run) {
  page.chapter("Tracking");
  page.paragraph(fmt::format(
      "A {} of full stroke ({} um) through disturbance generator, compensator, amplifier and stage, integrated by "
      "CVODE until it repeats; rms error in percent of the range (eq. 8), as in the paper's Table II. The largest "
      "difference from the exact periodic solution is {} % of range.",
      to_string(run.project.track.waveform), rounded_text(run.project.plant.stroke_m * 1e6),
      rounded_text(run.tracking.max_cross_check_percent, 2)));
  page.table(tracking_table(run.tracking), "rms tracking error, % of range");
  page.figure(report::to_svg(tracking_plot(run.tracking)),
              "The tracking error of every alternative over the frequency.");
  page.figure(period_svg(run.tracking),
              "The error without any compensation is left out: it would dwarf the others.");
}

}  // namespace bodesmith::project
