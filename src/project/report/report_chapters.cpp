#include "project/report/report_chapters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "fpaa/plan/error_budget.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "schematic/writers/kicad/schematic.hpp"

namespace bodesmith::project {
namespace {

std::string root_text(const Complex& root) {
  if (root.imag() == 0.0)
    return hertz_text(RadPerSecond{std::abs(root)}.hz().value) + (root.real() > 0.0 ? " (right)" : "");
  return fmt::format("{}, Q {}", hertz_text(RadPerSecond{std::abs(root)}.hz().value),
                     rounded_text(-0.5 * std::abs(root) / root.real(), 3));
}

std::string list_of_roots(const std::vector<Complex>& roots) {
  std::vector<std::string> out;
  for (const Complex& root : roots) {
    if (root.imag() >= 0.0) out.push_back(root_text(root));
  }
  return out.empty() ? "-" : join(out, "; ");
}

}  // namespace

std::string hertz_text(double value) {
  return engineering_text(value, "Hz", 4);
}

std::string span_text(const Band& band) {
  return hertz_text(band.from.value) + " to " + hertz_text(band.to.value);
}

report::Table limits_table(const std::vector<LimitCheck>& limits) {
  report::Table table{{"limit", "asked", "got", ""}, {}, {}};
  for (const LimitCheck& check : limits) {
    if (!check.met()) table.marked.push_back(table.rows.size());
    table.rows.push_back(
        {check.name, rounded_text(check.limit), check.got_text(), check.met() ? "met" : "not met"});
  }
  return table;
}

report::Table sections_table(const Sections& sections) {
  report::Table table{{"section", "gain", "zeros", "poles"}, {}, {}};
  for (const Section& section : sections.sections) {
    table.rows.push_back({std::to_string(table.rows.size() + 1), rounded_text(section.gain, 6),
                          list_of_roots(section.zeros), list_of_roots(section.poles)});
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

std::string text_of(const std::string& caption, const report::Table& table) {
  std::vector<std::vector<std::string>> rows = {table.head};
  rows.front().front() = caption;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    rows.push_back(table.rows[i]);
    rows.back().front().insert(0, std::ranges::count(table.marked, i) > 0 ? "* " : "  ");
  }
  std::vector<std::size_t> widths(table.head.size(), 0);
  for (const std::vector<std::string>& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  std::string out;
  for (const std::vector<std::string>& row : rows) {
    out += fmt::format("{:<{}}", row.front(), widths.front());
    for (std::size_t k = 1; k < row.size(); ++k) out += fmt::format("  {:>{}}", row[k], widths[k]);
    out += "\n";
  }
  return out;
}

std::string sections_caption(const Sections& sections) {
  return fmt::format("H(s) = {} times the product of these", rounded_text(sections.gain, 8));
}

report::Plot trade_off_plot(const fpaa::Plan& plan) {
  report::Plot plot;
  plot.title = "Error of 95 % of boards against the largest input";
  plot.x = {.label = "largest input, V", .logarithmic = true};
  plot.y = {.label = "error, %", .logarithmic = true};
  report::Series curve{.name = "designs", .x = {}, .y = {}};
  report::Series taken{.name = "taken", .x = {}, .y = {}, .style = report::Series::Style::marks};
  for (const fpaa::TradeOff& at : plan.trade_off) {
    for (report::Series* series : {&curve, at.chosen ? &taken : nullptr}) {
      if (series == nullptr) continue;
      series->x.push_back(at.at_input_v);
      series->y.push_back(at.p95_percent);
    }
  }
  plot.series = {curve, taken};
  return plot;
}

void board_chapter(report::Page& page, const Run& run) {
  const std::optional<fpaa::Plan>& plan = run.design.plan;
  const std::string& refused = run.design.no_plan;
  if (!plan && refused.empty()) return;
  page.chapter("FPAA");
  if (!plan) {
    page.warning("No plan: " + refused);
    return;
  }
  const fpaa::PlanError& runs = plan->error_with_delays;
  page.paragraph(fmt::format(
      "{} CAMs on {} chip(s) of {}. As the board runs, every switch of every clock in it, from {}: {} % ({} dB, {} "
      "degrees), worst at {}. {}Largest input {}.",
      plan->cams().size(), plan->chips.size(), plan->board, span_text(runs.band),
      rounded_text(runs.max_complex_percent, 3), rounded_text(runs.max_magnitude_db, 3),
      rounded_text(runs.max_phase_deg, 3), hertz_text(runs.worst.value),
      plan->total ? fmt::format("95 % of boards, mismatch and noise in it: {} %. ",
                                rounded_text(plan->total->p95_percent, 3))
                  : "",
      engineering_text(plan->max_input_v, "V")));
  if (const std::string late = late_text(*plan, late_figure(*plan, run.design.sections())); !late.empty())
    page.paragraph("As the board runs, " + late);
  page.figure(fpaa::board_picture_svg(*plan), "Chips, configurable blocks, wires and what is used of them.");
  page.table(cams_table(*plan),
             "As entered in the designer; the full build sheet is in the folder of the plan.");
  for (const std::string& note : plan->notes) page.paragraph(note);
  if (!plan->trade_off.empty())
    page.plots({trade_off_plot(*plan)},
               "Designs that no other one found beats in both, error and input, and is as near by design.");
  for (const std::string& assumption : plan->assumptions) page.warning("Assumed: " + assumption);
}

void circuit_chapter(report::Page& page, const Run& run) {
  const std::optional<synthesis::BuildChoice>& choice = run.design.circuit;
  const std::optional<synthesis::CompensatorCheck>& ngspice = run.ngspice;
  if (!choice) return;
  const synthesis::Candidate& best = choice->best;
  page.chapter("Circuit");
  page.paragraph(fmt::format(
      "{}: {} stages, {} op-amps ({}), {} parts ({} resistors, {} capacitors). From {} parts and op-amps together are {} dB "
      "and {} degrees off; least phase margin of an op-amp {} degrees.",
      best.how, best.made.circuit.stages.size(), best.made.circuit.opamps.size(),
      best.made.circuit.opamp.name, best.made.circuit.parts.size(), run.project.circuit->resistors,
      run.project.circuit->capacitors, span_text(best.judged_band),
      rounded_text(best.judged.max_magnitude_db, 3), rounded_text(best.judged.max_phase_deg, 3),
      rounded_text(best.opamps.min_phase_margin_deg, 3)));
  if (ngspice) {
    page.paragraph(fmt::format(
        "ngspice on the emitted netlist, {}: {} dB from the program's own network solution, {} dB and {} "
        "degrees from the sections.",
        span_text(ngspice->band), rounded_text(ngspice->against_network.max_magnitude_db, 3),
        rounded_text(ngspice->against_sections.max_magnitude_db, 3),
        rounded_text(ngspice->against_sections.max_phase_deg, 3)));
  }
  for (const std::string& reason : choice->passed_over) page.paragraph("Passed over: " + reason + ".");
  for (const std::string& shortfall : best.shortfalls) page.warning(shortfall);
  page.figure(kicad::netlist_svg(best.made.circuit, {.stem = "compensator",
                                                     .title = "Op-amp circuit",
                                                     .comment = "",
                                                     .ports = {"in", "out"},
                                                     .board = false}),
              "With connectors, supplies and decoupling on sheets of KiCad in the folder of the circuit.");
  page.table(
      parts_table(best.made.circuit.parts),
      "Parts of a stage scale together: one may lie some percent from its exact value where the others make up for it");
  for (const std::string& warning : best.opamps.warnings) page.warning(warning);
  if (run.project.plant && !ngspice) page.warning("ngspice is not installed: the netlist was not simulated.");
}

void inputs_chapter(report::Page& page, const Run& run) {
  page.chapter("Inputs");
  report::Table table{{"input", "SHA-256"}, {}, {}};
  for (const InputFile& file : run.from.inputs) table.rows.push_back({file.path, file.sha256});
  page.table(table);
}

}  // namespace bodesmith::project
