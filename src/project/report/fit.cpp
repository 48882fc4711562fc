#include <fmt/format.h>

#include "base/text.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
namespace {

report::Table fit_terms_table(const CascadeFit& fit) {
  report::Table table{
      {"band, Hz", "lambda, s", "x", "beta", "over its band", "change of beta for 1 % gain error"}, {}, {}};
  for (std::size_t i = 0; i < fit.terms.size(); ++i) {
    const CascadeFitTerm& term = fit.terms[i];
    const auto& g = fit.cascade.terms[i];
    table.rows.push_back(
        {fmt::format("{} - {}", rounded_text(term.band.from.value), rounded_text(term.band.to.value)),
         rounded_text(g.lambda_s, 6), rounded_text(g.x, 6), fmt::format("{:+.4f}", g.beta),
         std::string(term.rises ? "rises (lead)" : "falls (lag)") + (term.at_bound ? ", at its bound" : ""),
         fmt::format("{:.3f}", term.max_sensitivity)});
  }
  return table;
}

report::Table fit_points_table(const Cascade& cascade) {
  report::Table table{{"frequency, Hz", "target, dB", "got, dB", "error, dB"}, {}, {}};
  for (const Cascade::FitPoint& point : cascade.fit->points) {
    table.rows.push_back({rounded_text(point.frequency.value, 6), fmt::format("{:.5f}", point.wanted_db),
                          fmt::format("{:.5f}", point.got_db),
                          fmt::format("{:.1e}", point.got_db - point.wanted_db)});
  }
  return table;
}

}  // namespace

void fit_chapter(report::Page& page, const Run& run) {
  if (!run.project.plant) return;
  page.chapter("Fit");
  const CascadeFit& fit = *run.design.fit;
  page.paragraph(fit.bounded ? fmt::format("Bounded least squares (eq. 19), {} <= beta <= {}.",
                                           rounded_text(fit.lower_bound), rounded_text(fit.upper_bound))
                             : "Interpolation of every point above the base (eq. 18).");
  page.paragraph(fmt::format(
      "Condition number {}. At the base frequency the cascade's magnitude is {:.4f} dB: a consequence of "
      "the fit; the gain is exactly 1 only at 0 Hz.",
      rounded_text(fit.condition_number), fit.base_got_db));
  page.table(fit_terms_table(fit), "Terms ((lambda s + 1)/(x lambda s + 1))^beta");
  page.table(fit_points_table(fit.cascade));
  for (const std::string& warning : fit.warnings) page.warning(warning);
}

}  // namespace bodesmith::project
