#include <fmt/format.h>

#include "base/text.hpp"
#include "project/output/run_files.hpp"
#include "project/report/report_chapters.hpp"
#include "report/page.hpp"

namespace bodesmith::project {

// Each in a file of its own in project/report/, but for those of the hardware and the inputs; it is empty where there is nothing
// to say.
void target_chapter(report::Page& page, const Run& run);
void fit_chapter(report::Page& page, const Run& run);
void sections_chapter(report::Page& page, const Run& run);
void budget_chapter(report::Page& page, const Run& run);
void tracking_chapter(report::Page& page, const Run& run);
void board_chapter(report::Page& page, const Run& run);
void circuit_chapter(report::Page& page, const Run& run);
void layout_chapter(report::Page& page, const Run& run);
void part_errors_chapter(report::Page& page, const Run& run);
void tolerances_chapter(report::Page& page, const Run& run);
void inputs_chapter(report::Page& page, const Run& run);

namespace {

std::vector<std::pair<std::string, std::string>> key_figures(const Run& run) {
  const Design& design = run.design;
  std::vector<std::pair<std::string, std::string>> out;
  if (design.fit)
    out.emplace_back(fmt::format("{:.1e} dB", design.fit->cascade.fit->max_db),
                     "largest error of the cascade at the points");
  if (design.approximation)
    out.emplace_back(
        rounded_text(design.approximation->error.everywhere_db, 3) + " dB",
        fmt::format("sections against cascade, {} poles", design.approximation->sections.pole_count()));
  if (!run.project.plant && !run.project.target.sections)
    out.emplace_back(rounded_text(design.built().points_max_db, 3) + " dB", "sections against the target");
  if (design.plan)
    out.emplace_back(rounded_text(design.plan->error_with_delays.max_complex_percent, 3) + " %",
                     "FPAA against the sections, as the board runs");
  if (design.circuit)
    out.emplace_back(rounded_text(design.circuit->best.judged.max_magnitude_db, 3) + " dB",
                     "circuit with its op-amps against the sections");
  if (design.yield)
    out.emplace_back(rounded_text(design.yield->worst_db.quantile(0.95), 3) + " dB",
                     "95 of 100 circuits, tolerances in it");
  return out;
}

void summary_chapter(report::Page& page, const Run& run) {
  page.chapter("Summary");
  if (run.project.plant)
    page.table(headline_table(run.project, run.tracking),
               fmt::format("Worst rms tracking error, % of range, {}, {}", to_string(run.tracking.waveform),
                           frequency_span(run.tracking)));
  page.key_figures(key_figures(run));
  if (!run.limits.empty()) page.table(limits_table(run.limits));
  for (const std::string& finding : run.tracking.findings) page.warning(finding);
}

}  // namespace

std::string report_page(const Run& run) {
  report::Page page(run.project.name,
                    "From the target to checked hardware: what was asked for, and the error of each step.");
  for (const auto& chapter : {summary_chapter, target_chapter, fit_chapter, sections_chapter, budget_chapter,
                              tracking_chapter, board_chapter, circuit_chapter, layout_chapter,
                              part_errors_chapter, tolerances_chapter, inputs_chapter})
    chapter(page, run);
  return page.html();
}

}  // namespace bodesmith::project
