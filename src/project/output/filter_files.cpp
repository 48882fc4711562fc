#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "project/output/run_files.hpp"
#include "project/report/report_chapters.hpp"
#include "project/run.hpp"
#include "report/page.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::project {
namespace {

using report::Series;

constexpr int kPlotPoints = 301;

/// A third of a decade beyond the band: what happens at its ends.
std::vector<Hertz> grid_about(const Band& band, int count) {
  return log_grid({Hertz{band.from.value / 2.0}, Hertz{band.to.value * 2.0}}, count);
}

/// All stages, and what each leaves: of the target's response where that is known everywhere, else of the sections.
std::vector<report::Plot> filter_plots(const FilterRun& run) {
  const FilterProject& project = run.project;
  const report::BodePlot plot = stages_bode(filter_stages(run.design), grid_about(project.band, kPlotPoints),
                                            project.points ? &*project.points : nullptr);
  const bool known = project.fractional.has_value();
  const auto reference_db = [&](Hertz f) {
    const RadPerSecond w = f.rad_s();
    return to_decibel(std::abs(known ? *project.target_response(w) : run.design.sections.response(w)));
  };
  return {plot.magnitude, plot.phase,
          difference_plot(plot.magnitude, known ? "Error against the target" : "Difference from the sections",
                          project.band, reference_db, known ? "" : "sections")};
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

void sections_of_filter(report::Page& page, const FilterRun& run) {
  page.chapter("Sections");
  if (run.design.approximation) {
    page.paragraph(fmt::format("The cascade approximated by {}: at most {} dB off at any frequency.",
                               run.design.approximation->method,
                               rounded_text(run.design.approximation->error.everywhere_db, 3)));
  }
  add_sections_table(page, run.design.sections);
}

void yield_of_filter(report::Page& page, const FilterRun& run) {
  if (!run.design.yield) return;
  const tolerance::Result& result = *run.design.yield;
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
  add_board_chapter(page, run.design.plan, run.design.no_plan);
  add_circuit_chapter(page, run.design.circuit, run.project.circuit);
  yield_of_filter(page, run);
  add_inputs_chapter(page, run.from);
  return page.html();
}

constexpr int kTableRows = 241;

std::string document(std::string_view schema, const FilterRun& run, const Json& body) {
  return to_text(timed_json(schema, run.from, body, run.design.compute_s));
}

void add_circuit_files(const FilterRun& run, OutputSet& out) {
  const synthesis::Candidate& best = run.design.circuit->best;
  OutputSet spice;
  synthesis::add_compensator_files(best.made, run.project.name, spice);
  out.include("spice", spice);
  Json json = synthesis::to_json(best.made);
  json["judged"] = synthesis::judged_json(best.judged, best.judged_band);
  json["shortfalls"] = best.shortfalls;
  out.add("spice/circuit.json", document("circuit", run, json));
}

Json tolerances_json(const FilterRun& run) {
  tolerance::Options options;
  options.limit_db = run.project.limits.yield_db;
  return tolerance::to_json(*run.design.yield, options);
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
  out.add("bode.csv", stages_csv(filter_stages(run.design), grid_about(run.project.band, kTableRows)));
  out.add("bode.svg", filter_svg(run));
  out.add("report.html", filter_page(run));
  return out;
}

}  // namespace bodesmith::project
