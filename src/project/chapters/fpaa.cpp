#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "project/report_tables.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
void fpaa_chapter(report::Page& page, const ProjectRun& run) {
  if (!run.design.plan) return;
  const fpaa::Plan& plan = *run.design.plan;
  page.chapter("FPAA");
  page.paragraph(fmt::format(
      "{} filter blocks on {} chip(s) of {}. Worst complex error against the sections as the board runs, every hold "
      "and delay in it: {} % between {} and {} Hz.",
      plan.cams().size(), plan.chips.size(), plan.board,
      rounded_text(plan.error_with_delays.max_complex_percent, 3),
      rounded_text(plan.error_with_delays.band.from.value),
      rounded_text(plan.error_with_delays.band.to.value)));
  page.figure(fpaa::board_picture_svg(plan), "Chips, configurable blocks, wires and what is used of them.");
  page.table(cams_table(plan),
             "As entered in the designer; the full build sheet is in the folder of the plan.");
  for (const std::string& note : plan.notes) page.paragraph(note);
  for (const std::string& assumption : plan.assumptions) page.warning("Assumed: " + assumption);
}

}  // namespace bodesmith::project
