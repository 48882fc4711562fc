#include "project/report/report_page.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "report/page.hpp"

namespace bodesmith::project {

// Each in a file of its own in project/report/.
void target_chapter(report::Page& page, const ProjectRun& run);
void fit_chapter(report::Page& page, const ProjectRun& run);
void sections_chapter(report::Page& page, const ProjectRun& run);
void budget_chapter(report::Page& page, const ProjectRun& run);
void tracking_chapter(report::Page& page, const ProjectRun& run);
void layout_chapter(report::Page& page, const ProjectRun& run);
void part_errors_chapter(report::Page& page, const ProjectRun& run);

namespace {

std::vector<std::pair<std::string, std::string>> key_figures(const Design& design) {
  std::vector<std::pair<std::string, std::string>> out;
  if (design.fit.cascade.fit) {
    out.emplace_back(fmt::format("{:.1e} dB", design.fit.cascade.fit->max_db),
                     "largest error of the cascade at the points");
  }
  out.emplace_back(
      rounded_text(design.approximation.error.everywhere_db, 3) + " dB",
      fmt::format("sections against cascade, {} poles", design.approximation.sections.pole_count()));
  if (design.plan) {
    out.emplace_back(rounded_text(design.plan->error_with_delays.max_complex_percent, 3) + " %",
                     "FPAA plan against sections, as the board runs");
  }
  if (design.circuit) {
    out.emplace_back(rounded_text(design.realised().report.parts.max_magnitude_db, 3) + " dB",
                     "circuit's parts against sections");
  }
  return out;
}

report::Table headline_table(const ProjectRun& run) {
  report::Table table{{"", "as it is", "pure delay removed"}, {}, {}};
  for (const HeadlineRow& row : headline(run.project, run.tracking)) {
    table.rows.push_back({row.what, row.as_it_is_percent ? fmt::format("{:.3f}", *row.as_it_is_percent) : "",
                          row.without_lag});
  }
  return table;
}

void summary_chapter(report::Page& page, const ProjectRun& run) {
  page.chapter("Summary");
  page.table(headline_table(run),
             fmt::format("Worst rms tracking error, % of range, {}, {}", to_string(run.tracking.waveform),
                         frequency_span(run.tracking)));
  page.key_figures(key_figures(run.design));
  if (!run.limits.empty()) page.table(limits_table(run.limits));
  for (const std::string& finding : run.tracking.findings) page.warning(finding);
}

}  // namespace

std::string report_page(const ProjectRun& run) {
  report::Page page(
      run.project.name,
      "From the target magnitude to checked hardware: what was asked for, and the error of each step.");
  summary_chapter(page, run);
  target_chapter(page, run);
  fit_chapter(page, run);
  sections_chapter(page, run);
  budget_chapter(page, run);
  tracking_chapter(page, run);
  add_board_chapter(page, run.design.plan);
  add_circuit_chapter(page, run.design.circuit, run.project.circuit, run.ngspice);
  if (run.design.circuit && !run.ngspice)
    page.warning("ngspice is not installed: the netlist was not simulated.");
  layout_chapter(page, run);
  part_errors_chapter(page, run);
  add_inputs_chapter(page, run.from);
  return page.html();
}

}  // namespace bodesmith::project
