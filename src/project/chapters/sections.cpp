#include <fmt/format.h>

#include "base/text.hpp"
#include "project/alternatives_page.hpp"
#include "project/report_tables.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
namespace {

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

void sections_chapter(report::Page& page, const ProjectRun& run) {
  page.chapter("Sections");
  const CascadeApproximation& a = run.design.approximation;
  page.paragraph(fmt::format(
      "The cascade approximated by the method {}: {} poles in all. Largest error {} dB over all frequencies, {} dB "
      "and {} degrees between {} and {} Hz.",
      a.method, a.sections.pole_count(), rounded_text(a.error.everywhere_db, 3),
      rounded_text(a.error.band_db, 3), rounded_text(a.error.band_deg, 3),
      rounded_text(a.error.band.from.value), rounded_text(a.error.band.to.value)));
  if (!a.limit_met) page.warning("The error limit could not be met at the largest order.");
  page.table(approximated_terms_table(a));
  add_alternatives(page, run);
  for (const std::string& reason : run.design.passed_over)
    page.paragraph("Passed over because it cannot be built: " + reason);
  const Sections& built = run.design.sections();
  page.table(sections_table(built),
             fmt::format("H(s) = {} times the product of these", rounded_text(built.gain, 8)));
}

}  // namespace bodesmith::project
