#include <fmt/format.h>

#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
namespace {

using TableRow = std::vector<std::string>;

TableRow with_waveform(TableRow cells, const WaveformError& waveform) {
  cells.push_back(fmt::format("{:.3f}", waveform.rms_percent));
  cells.push_back(fmt::format("{:.3f}", waveform.worst_percent));
  return cells;
}

TableRow budget_cells(const BudgetRow& row) {
  const bool first = row.previous.empty();
  const auto cell = [first](double value) { return first ? std::string() : rounded_text(value, 3); };
  return {row.stage,
          row.previous,
          cell(row.against_previous.max_magnitude_db),
          cell(row.against_previous.max_phase_deg),
          cell(row.against_previous.max_complex_percent),
          rounded_text(row.points_max_db, 3)};
}

}  // namespace

report::Table budget_table(const Budget& budget) {
  report::Table table{{"stage", "against", "dB", "degrees", "complex, %", "error at the points, dB",
                       "waveform rms, %", "worst frequency, %"},
                      {},
                      {}};
  table.rows.push_back(with_waveform({"no rate compensation", "", "", "", "", ""}, budget.uncompensated));
  table.rows.push_back(with_waveform(
      {fmt::format("best fixed gain, {:.4f}", budget.constant_gain), "", "", "", "", ""}, budget.constant));
  for (const BudgetRow& row : budget.rows) {
    if (row.waveform.worst_percent > budget.uncompensated.worst_percent)
      table.marked.push_back(table.rows.size());
    table.rows.push_back(with_waveform(budget_cells(row), row.waveform));
  }
  return table;
}

void budget_chapter(report::Page& page, const Run& run) {
  if (!run.project.plant) return;
  page.chapter("Error budget");
  page.plots(
      stages_plots(run.project, run.design),
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
