#include <fmt/format.h>

#include "base/text.hpp"
#include "project/report_tables.hpp"
#include "project/run.hpp"
#include "project/stages_plot.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
void budget_chapter(report::Page& page, const ProjectRun& run) {
  page.chapter("Error budget");
  page.plots(
      stages_plots(run.project, run.design, run.budget),
      "Every stage in one plot. The holds of the sampled FPAA chain shift the phase far more than anything "
      "else does; its magnitude stays.");
  page.table(
      budget_table(run.budget),
      fmt::format("Each stage against the one before it between {} and {} Hz; and the waveform that it makes "
                  "of the disturbance at the tracked frequencies, in percent of the stage's range. Marked: "
                  "worse than no rate compensation.",
                  rounded_text(run.budget.band.from.value), rounded_text(run.budget.band.to.value)));
  if (run.budget.magnitude_only_is_worse) {
    page.warning(
        "The magnitude fits, and yet the compensating waveform is worse than with no rate compensation at all: the "
        "compensator also shifts the phase of the waveform and of its harmonics. Fit the waveform itself instead.");
  }
}

}  // namespace bodesmith::project
