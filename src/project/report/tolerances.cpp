#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "project/run.hpp"
#include "report/page.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::project {

void tolerances_chapter(report::Page& page, const Run& run) {
  if (!run.design.yield) return;
  const tolerance::Result& result = *run.design.yield;
  page.chapter("Tolerances");
  page.paragraph(fmt::format(
      "{} circuits with resistors within {} % and capacitors within {} %, against the sections from {}: 95 of 100 stay within "
      "{} dB (half of them within {} dB).",
      result.samples, rounded_text(run.project.spread.resistor_percent),
      rounded_text(run.project.spread.capacitor_percent), span_text(run.project.target.band),
      rounded_text(result.worst_db.quantile(0.95), 3), rounded_text(result.worst_db.quantile(0.5), 3)));
  report::Plot plot;
  plot.title = "Deviation from the sections";
  plot.x = {"frequency, Hz", true};
  plot.y = {"dB"};
  plot.height = 260;
  for (const auto& [name, p] : {std::pair{"2.5 %", 0.025}, {"median", 0.5}, {"97.5 %", 0.975}}) {
    report::Series series{
        name, {}, {}, p == 0.5 ? report::Series::Style::line : report::Series::Style::dashed, 0};
    for (std::size_t i = 0; i < result.grid.size(); ++i) {
      series.x.push_back(result.grid[i].value);
      series.y.push_back(result.magnitude_db[i].quantile(p));
    }
    plot.series.push_back(std::move(series));
  }
  page.plots({plot}, "Between the dashed lines lie 95 of 100 circuits at each frequency.");
  report::Table table{{"part", "share of the variance, %"}, {}, {}};
  for (std::size_t i = 0; i < std::min<std::size_t>(8, result.ranking.size()); ++i)
    table.rows.push_back({result.ranking[i].part, rounded_text(100.0 * result.ranking[i].share, 3)});
  page.table(table, "Parts that matter most");
}

}  // namespace bodesmith::project
