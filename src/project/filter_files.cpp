#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/json.hpp"
#include "base/text.hpp"
#include "circuit/json.hpp"
#include "fpaa/sheets/board_picture.hpp"
#include "kicad/schematic.hpp"
#include "project/artefacts.hpp"
#include "project/report_tables.hpp"
#include "project/run.hpp"
#include "project/run_files.hpp"
#include "report/bode.hpp"
#include "report/page.hpp"
#include "spice/emit.hpp"
#include "yield/json.hpp"

namespace bodesmith::project {
namespace {

using report::Series;

constexpr int kPlotPoints = 301;

std::string hertz_text(double value) {
  return engineering_text(value, "Hz", 4);
}

std::string span_text(const Band& band) {
  return hertz_text(band.from.value) + " to " + hertz_text(band.to.value);
}

/// A third of a decade beyond the band: what happens at its ends.
std::vector<Hertz> plot_grid(const Band& band) {
  return log_grid({Hertz{band.from.value / 2.0}, Hertz{band.to.value * 2.0}}, kPlotPoints);
}

std::vector<double> values_of(const std::vector<Hertz>& grid) {
  std::vector<double> out;
  for (const Hertz f : grid) out.push_back(f.value);
  return out;
}

struct StageCurve {
  std::string name;
  std::vector<std::complex<double>> response;
};

std::vector<StageCurve> curves_of(const FilterRun& run, const std::vector<Hertz>& grid) {
  std::vector<StageCurve> out;
  for (const FilterStage& stage : filter_stages(run.design)) {
    out.push_back({stage.name, {}});
    for (const Hertz f : grid) out.back().response.push_back(stage.response(f.rad_s()));
  }
  return out;
}

std::vector<double> unwrapped_degrees(const std::vector<std::complex<double>>& response) {
  std::vector<double> out;
  double last = 0.0;
  for (const std::complex<double>& h : response) {
    double angle = to_degrees(std::arg(h));
    angle += 360.0 * std::round((last - angle) / 360.0);
    last = angle;
    out.push_back(angle);
  }
  return out;
}

std::vector<double> decibels_of(const std::vector<std::complex<double>>& response) {
  std::vector<double> out;
  for (const std::complex<double>& h : response) out.push_back(to_decibel(std::abs(h)));
  return out;
}

/// What each stage leaves: of the target's response where that is known everywhere, else of the sections, the points as
/// marks.
report::Plot error_plot(const FilterRun& run, const std::vector<Hertz>& grid,
                        const std::vector<StageCurve>& curves) {
  const FilterProject& project = run.project;
  const bool known = project.fractional.has_value();
  report::Plot out;
  out.title = known ? "Error against the target" : "Difference from the sections";
  out.x = {"frequency, Hz", true};
  out.y = {"dB"};
  out.height = 260;
  int colour = 0;
  double largest = 1e-4;
  for (const StageCurve& curve : curves) {
    const int own = colour++;
    if (!known && curve.name == "sections") continue;
    Series series{curve.name, values_of(grid), {}, Series::Style::line, own};
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const RadPerSecond w = grid[i].rad_s();
      const std::complex<double> wanted =
          known ? *project.target_response(w) : run.design.sections.response(w);
      series.y.push_back(to_decibel(std::abs(curve.response[i] / wanted)));
      if (grid[i] >= project.band.from && grid[i] <= project.band.to)
        largest = std::max(largest, std::abs(series.y.back()));
    }
    out.series.push_back(std::move(series));
  }
  if (project.points) {
    Series marks{"target", {}, {}, Series::Style::marks, 7};
    for (const BodePoint& point : project.points->points) {
      marks.x.push_back(point.frequency.value);
      marks.y.push_back(
          to_decibel(point.gain / std::abs(run.design.sections.response(point.frequency.rad_s()))));
      largest = std::max(largest, std::abs(marks.y.back()));
    }
    out.series.push_back(std::move(marks));
  }
  // What happens beyond the band must not flatten what happens in it.
  out.y.fixed = true;
  out.y.from = -1.15 * largest;
  out.y.to = 1.15 * largest;
  return out;
}

std::vector<report::Plot> filter_plots(const FilterRun& run) {
  const std::vector<Hertz> grid = plot_grid(run.project.band);
  const std::vector<StageCurve> curves = curves_of(run, grid);
  report::BodePlot plot;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const auto style = i % 2 == 0 ? Series::Style::line : Series::Style::dashed;
    plot.magnitude.series.push_back(
        {curves[i].name, values_of(grid), decibels_of(curves[i].response), style, static_cast<int>(i)});
    plot.phase.series.push_back(
        {curves[i].name, values_of(grid), unwrapped_degrees(curves[i].response), style, static_cast<int>(i)});
  }
  if (run.project.points) {
    Series marks{"target", {}, {}, Series::Style::marks, 7};
    for (const BodePoint& point : run.project.points->points) {
      marks.x.push_back(point.frequency.value);
      marks.y.push_back(to_decibel(point.gain));
    }
    plot.magnitude.series.push_back(std::move(marks));
  }
  return {plot.magnitude, plot.phase, error_plot(run, grid, curves)};
}

void target_of_filter(report::Page& page, const FilterRun& run) {
  const FilterProject& project = run.project;
  page.chapter("Target");
  page.paragraph(
      fmt::format("{}, judged from {}. {}", project.target_file, span_text(project.band), run.design.how));
  page.plots(
      filter_plots(run),
      "Gain and phase of every stage, and beneath them what each leaves. Beyond the band nothing was asked.");
  if (!project.points || project.points->points.size() > 60) return;
  report::Table table{{"frequency", "target, dB", "sections, dB", "error, dB"}, {}, {}};
  for (const BodePoint& point : project.points->points) {
    const double target = to_decibel(point.gain);
    const double got = to_decibel(std::abs(run.design.sections.response(point.frequency.rad_s())));
    table.rows.push_back({hertz_text(point.frequency.value), fmt::format("{:.3f}", target),
                          fmt::format("{:.3f}", got), fmt::format("{:+.4f}", got - target)});
  }
  page.table(table);
}

std::string root_text(const std::complex<double>& root) {
  if (root.imag() == 0.0)
    return hertz_text(RadPerSecond{std::abs(root)}.hz().value) + (root.real() > 0.0 ? " (right)" : "");
  return fmt::format("{}, Q {}", hertz_text(RadPerSecond{std::abs(root)}.hz().value),
                     rounded_text(-0.5 * std::abs(root) / root.real(), 3));
}

std::string list_of_roots(const std::vector<std::complex<double>>& roots) {
  std::vector<std::string> out;
  for (const std::complex<double>& root : roots) {
    if (root.imag() >= 0.0) out.push_back(root_text(root));
  }
  return out.empty() ? "-" : join(out, "; ");
}

void sections_of_filter(report::Page& page, const FilterRun& run) {
  page.chapter("Sections");
  if (run.design.approximation) {
    page.paragraph(fmt::format("The cascade approximated by {}: at most {} dB off at any frequency.",
                               run.design.approximation->method,
                               rounded_text(run.design.approximation->error.everywhere_db, 3)));
  }
  report::Table table{{"section", "gain", "zeros", "poles"}, {}, {}};
  for (const Section& section : run.design.sections.sections) {
    table.rows.push_back({std::to_string(table.rows.size() + 1), rounded_text(section.gain, 6),
                          list_of_roots(section.zeros), list_of_roots(section.poles)});
  }
  page.table(table,
             fmt::format("H(s) = {} times the product of these", rounded_text(run.design.sections.gain, 8)));
}

void board_of_filter(report::Page& page, const FilterRun& run) {
  if (!run.project.fpaa) return;
  page.chapter("FPAA");
  if (!run.design.plan) {
    page.warning("No plan: " + run.design.no_plan);
    return;
  }
  const fpaa::Plan& plan = *run.design.plan;
  const fpaa::PlanError& runs = plan.error_with_delays;
  page.paragraph(fmt::format(
      "{} CAMs on {} chip(s) of {}. As the board runs, every switch of every clock in it, from {}: {} % ({} dB, {} "
      "degrees), worst at {}. Largest input {}.",
      plan.cams().size(), plan.chips.size(), plan.board, span_text(runs.band),
      rounded_text(runs.max_complex_percent, 3), rounded_text(runs.max_magnitude_db, 3),
      rounded_text(runs.max_phase_deg, 3), hertz_text(runs.worst.value),
      engineering_text(plan.max_input_v, "V")));
  page.figure(fpaa::board_picture_svg(plan), "Chips, configurable blocks, wires and what is used of them.");
  for (const std::string& note : plan.notes) page.paragraph(note);
  for (const std::string& assumption : plan.assumptions) page.warning("Assumed: " + assumption);
}

void circuit_of_filter(report::Page& page, const FilterRun& run) {
  if (!run.design.circuit) return;
  const circuit::Candidate& best = run.design.circuit->best;
  page.chapter("Circuit");
  page.paragraph(fmt::format(
      "{}: {} stages, {} op-amps ({}), {} parts ({} resistors, {} capacitors). From {} parts and op-amps together are {} dB "
      "and {} degrees off; least phase margin of an op-amp {} degrees.",
      best.how, best.made.circuit.stages.size(), best.made.circuit.opamps.size(),
      best.made.circuit.opamp.name, best.made.circuit.parts.size(), run.project.circuit->resistors,
      run.project.circuit->capacitors, span_text(best.judged_band),
      rounded_text(best.judged.max_magnitude_db, 3), rounded_text(best.judged.max_phase_deg, 3),
      rounded_text(best.opamps.min_phase_margin_deg, 3)));
  for (const std::string& reason : run.design.circuit->passed_over)
    page.paragraph("Passed over: " + reason + ".");
  for (const std::string& shortfall : best.shortfalls) page.warning(shortfall);
  page.table(parts_table(best.made.circuit.parts));
  for (const std::string& warning : best.opamps.warnings) page.warning(warning);
}

void yield_of_filter(report::Page& page, const FilterRun& run) {
  if (!run.design.yield) return;
  const yield::Result& result = *run.design.yield;
  page.chapter("Tolerances");
  page.paragraph(fmt::format(
      "{} circuits with resistors within {} % and capacitors within {} %, against the sections from {}: 95 of 100 stay within "
      "{} dB (half of them within {} dB).",
      result.samples, rounded_text(run.project.spread.resistor_percent),
      rounded_text(run.project.spread.capacitor_percent), span_text(run.project.band),
      rounded_text(result.worst_db.quantile(0.95), 3), rounded_text(result.worst_db.quantile(0.5), 3)));
  report::Plot plot;
  plot.title = "Deviation from the sections";
  plot.x = {"frequency, Hz", true};
  plot.y = {"dB"};
  plot.height = 260;
  for (const auto& [name, p] : {std::pair{"2.5 %", 0.025}, {"median", 0.5}, {"97.5 %", 0.975}}) {
    Series series{name, {}, {}, p == 0.5 ? Series::Style::line : Series::Style::dashed, 0};
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

/// Gain and phase of every stage, and beneath them what each leaves of the target.
std::string filter_svg(const FilterRun& run) {
  return report::stack_svg(filter_plots(run));
}

/// report.html.
std::string filter_page(const FilterRun& run) {
  report::Page page(run.project.name,
                    "From the target response to checked hardware, and the error of each step.");
  page.chapter("Summary");
  std::vector<std::pair<std::string, std::string>> figures;
  if (!run.project.sections)
    figures.emplace_back(rounded_text(run.design.target_db, 3) + " dB", "sections against the target");
  if (run.design.plan)
    figures.emplace_back(rounded_text(run.design.plan->error_with_delays.max_complex_percent, 3) + " %",
                         "FPAA against the sections, as it runs");
  if (run.design.circuit)
    figures.emplace_back(rounded_text(run.design.circuit->best.judged.max_magnitude_db, 3) + " dB",
                         "circuit with its op-amps against the sections");
  if (run.design.yield)
    figures.emplace_back(rounded_text(run.design.yield->worst_db.quantile(0.95), 3) + " dB",
                         "95 of 100 circuits, tolerances in it");
  page.key_figures(figures);
  if (!run.limits.empty()) page.table(limits_table(run.limits));
  target_of_filter(page, run);
  sections_of_filter(page, run);
  board_of_filter(page, run);
  circuit_of_filter(page, run);
  yield_of_filter(page, run);
  page.chapter("Inputs");
  page.table(inputs_table(run.from));
  return page.html();
}

constexpr int kTableRows = 241;

std::string document(std::string_view schema, const FilterRun& run, const Json& body) {
  return artefact_json(schema, run.from, body, run.design.compute_s);
}

std::string bode_table(const FilterRun& run) {
  const Band& band = run.project.band;
  ResponseTable table(log_grid({Hertz{band.from.value / 2.0}, Hertz{band.to.value * 2.0}}, kTableRows));
  for (const FilterStage& stage : filter_stages(run.design)) table.add(stage.name, stage.response);
  return table.text();
}

void add_circuit_files(const FilterRun& run, OutputSet& out) {
  const circuit::Candidate& best = run.design.circuit->best;
  OutputSet spice;
  spice::add_spice_files(best.made, run.project.name, spice);
  kicad::add_kicad_files(best.made.circuit, run.project.name, spice);
  out.include("spice", spice);
  Json json = circuit::to_json(best.made);
  json["judged"] = circuit::to_json(best.judged);
  json["judged"]["band_hz"] = {best.judged_band.from.value, best.judged_band.to.value};
  json["shortfalls"] = best.shortfalls;
  out.add("spice/circuit.json", document("circuit", run, json));
}

Json tolerances_json(const FilterRun& run) {
  yield::Options options;
  options.limit_db = run.project.limits.yield_db;
  return yield::to_json(*run.design.yield, options);
}

}  // namespace

OutputSet filter_files(const FilterRun& run, const std::filesystem::path& folder) {
  OutputSet out(folder);
  if (run.design.fit) out.add("cascade.json", document("cascade", run, run.design.fit->to_json()));
  Json sections = run.design.sections.to_json();
  if (run.design.direct) sections["fit"] = run.design.direct->report_json();
  if (run.design.approximation) sections["approximation"] = run.design.approximation->report_json();
  out.add("sections.json", document("sections", run, sections));
  if (const auto& plan = run.design.plan)
    add_board_files(*plan, document("fpaa_plan", run, plan->to_json()), out);
  if (run.design.circuit) add_circuit_files(run, out);
  if (run.design.yield)
    out.add("yield.json", document("yield", run, {{"designs", Json::array({tolerances_json(run)})}}));
  out.add("bode.csv", bode_table(run));
  out.add("bode.svg", filter_svg(run));
  out.add("report.html", filter_page(run));
  return out;
}

}  // namespace bodesmith::project
