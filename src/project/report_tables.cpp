#include "project/report_tables.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"

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

std::string roots_text(const std::vector<std::complex<double>>& roots) {
  std::vector<std::string> parts;
  for (const auto& root : roots) {
    parts.push_back(root.imag() == 0.0
                        ? rounded_text(root.real(), 6)
                        : fmt::format("{} {} {}j", rounded_text(root.real(), 6), root.imag() < 0 ? "-" : "+",
                                      rounded_text(std::abs(root.imag()), 6)));
  }
  return parts.empty() ? std::string("-") : join(parts, ", ");
}

}  // namespace

report::Table limits_table(const std::vector<LimitCheck>& limits) {
  report::Table table{{"limit", "asked", "got", ""}, {}, {}};
  for (const LimitCheck& check : limits) {
    if (!check.met()) table.marked.push_back(table.rows.size());
    table.rows.push_back(
        {check.name, rounded_text(check.limit), check.got_text(), check.met() ? "met" : "not met"});
  }
  return table;
}

report::Table inputs_table(const Provenance& from) {
  report::Table table{{"input", "SHA-256"}, {}, {}};
  for (const InputFile& file : from.inputs) table.rows.push_back({file.path, file.sha256});
  return table;
}

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

report::Table sections_table(const Sections& sections) {
  report::Table table{{"section", "gain", "zeros, rad/s", "poles, rad/s"}, {}, {}};
  for (const Section& section : sections.sections) {
    table.rows.push_back({std::to_string(table.rows.size() + 1), rounded_text(section.gain, 6),
                          roots_text(section.zeros), roots_text(section.poles)});
  }
  return table;
}

report::Table parts_table(const std::vector<schematic::Part>& parts) {
  report::Table table{{"part", "stage", "series", "exact", "fitted", "difference, %"}, {}, {}};
  for (const schematic::Part& part : parts) {
    const char* unit = part.kind == schematic::Part::Kind::resistor ? "Ω" : "F";
    table.rows.push_back({part.name, std::to_string(part.group + 1), part.series,
                          engineering_text(part.wanted, unit, 5), engineering_text(part.realised, unit, 5),
                          fmt::format("{:+.2f}", 100.0 * (part.realised / part.wanted - 1.0))});
  }
  return table;
}

report::Table cams_table(const fpaa::Plan& plan) {
  report::Table table{{"CAM", "CAB", "clock, Hz", "capacitors"}, {}, {}};
  for (const fpaa::ChipPlan& chip : plan.chips) {
    for (const fpaa::PlacedCam& cam : chip.cams) {
      std::vector<std::string> capacitors;
      for (const auto& c : cam.capacitors) capacitors.push_back(fmt::format("{} {}", c.name, c.units));
      table.rows.push_back(
          {fmt::format("chip {} {} ({}, {})", chip.chip, cam.name, cam.cam_name(), cam.option),
           std::to_string(cam.cab), rounded_text(cam.clock_a.value, 6), join(capacitors, ", ")});
    }
  }
  return table;
}

}  // namespace bodesmith::project
