#include "project/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "fpaa/board_picture.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"

namespace bodesmith::project {
namespace {

using report::Page;
using report::Plot;
using report::Series;
using report::Table;

std::string text(double value, int digits = 4) {
  return rounded_text(value, digits);
}

std::vector<double> hertz(const std::vector<Hertz>& grid) {
  std::vector<double> out;
  for (const Hertz f : grid) out.push_back(f.value);
  return out;
}

Series wanted_points(const Project& project) {
  Series series{"wanted", {}, {}, Series::Style::marks, 7};
  for (const BodePoint& point : project.target.points.points) {
    series.x.push_back(point.frequency.value);
    series.y.push_back(to_decibel(point.gain));
  }
  return series;
}

void wish_chapter(Page& page, const ReportInput& in) {
  page.chapter("The wish");
  const Project& project = in.project;
  const bool ascending = project.target.branch == Disturbance::Branch::ascending;
  page.paragraph(
      fmt::format("The {} disturbance of the stage changes its size with the operating frequency. A "
                  "compensator is wanted whose gain "
                  "follows it through {} measured points, relative to {} Hz, so that the hysteresis that is "
                  "taken away is always as "
                  "large as the one that is there.",
                  ascending ? "ascending" : "descending", project.target.points.points.size(),
                  text(project.target.base.value)));
  Table table{{"frequency, Hz", "gain", "dB"}, {}, {}};
  for (const BodePoint& point : project.target.points.points) {
    table.rows.push_back(
        {text(point.frequency.value, 6), text(point.gain, 5), fmt::format("{:.4f}", to_decibel(point.gain))});
  }
  page.table(table);
  Plot polynomials;
  polynomials.title = "Full-stroke disturbance d(x)";
  polynomials.x = {"reference x"};
  polynomials.y = {"d, of range"};
  polynomials.height = 280;
  Series up{"ascending", {}, {}};
  Series down{"descending", {}, {}};
  for (int i = 0; i <= 100; ++i) {
    const double x = i / 100.0;
    up.x.push_back(x);
    down.x.push_back(x);
    up.y.push_back(project.target.disturbance.value(Disturbance::Branch::ascending, x));
    down.y.push_back(project.target.disturbance.value(Disturbance::Branch::descending, x));
  }
  polynomials.series = {up, down};
  page.figure(report::to_svg(polynomials), "The polynomials of both branches at the base frequency.");
}

void fit_chapter(Page& page, const ReportInput& in) {
  page.chapter("Fit");
  const CascadeFit& fit = in.design.fit;
  page.paragraph(fit.bounded ? fmt::format("Bounded least squares (eq. 19), {} <= beta <= {}.",
                                           text(fit.lower_bound), text(fit.upper_bound))
                             : "Interpolation of every point above the base (eq. 18).");
  page.paragraph(fmt::format(
      "Condition number {}. At the base frequency the cascade's magnitude is {} dB: a consequence "
      "of the fit, only 0 Hz has exactly gain 1.",
      text(fit.condition_number), fmt::format("{:.4f}", fit.base_got_db)));
  Table table{
      {"band, Hz", "lambda, s", "x", "beta", "over its band", "change of beta for 1 % gain error"}, {}, {}};
  for (size_t i = 0; i < fit.terms.size(); ++i) {
    const auto& term = fit.terms[i];
    const auto& g = fit.cascade.terms[i];
    table.rows.push_back(
        {fmt::format("{} - {}", text(term.band.from.value), text(term.band.to.value)), text(g.lambda_s, 6),
         text(g.x, 6), fmt::format("{:+.4f}", g.beta),
         std::string(term.rises ? "rises (lead)" : "falls (lag)") + (term.at_bound ? ", at its bound" : ""),
         fmt::format("{:.3f}", term.max_sensitivity)});
  }
  page.table(table, "Terms ((lambda s + 1)/(x lambda s + 1))^beta");
  if (fit.cascade.fit) {
    Table points{{"frequency, Hz", "wanted, dB", "got, dB", "miss, dB"}, {}, {}};
    for (const auto& point : fit.cascade.fit->points) {
      points.rows.push_back({text(point.frequency.value, 6), fmt::format("{:.5f}", point.wanted_db),
                             fmt::format("{:.5f}", point.got_db),
                             fmt::format("{:.1e}", point.got_db - point.wanted_db)});
    }
    page.table(points);
  }
  for (const std::string& warning : fit.warnings) page.warning(warning);
}

Table alternatives_table(const Design& design) {
  Table table{{"way", "poles", "at the points, dB", "phase there, degrees", "above the band, dB",
               "waveform rms, %", "worst frequency, %", "FPAA blocks"},
              {},
              {design.chosen}};
  for (const Alternative& a : design.alternatives) {
    table.rows.push_back({a.name, std::to_string(a.sections.pole_count()), text(a.points_max_db, 3),
                          text(a.phase_at_points_deg, 3), fmt::format("{:.2f}", a.above_band_db),
                          fmt::format("{:.3f}", a.waveform.rms_percent),
                          fmt::format("{:.3f}", a.waveform.worst_percent), std::to_string(a.fpaa_blocks)});
  }
  return table;
}

void sections_chapter(Page& page, const ReportInput& in) {
  page.chapter("Sections");
  const CascadeApproximation& a = in.design.approximation;
  page.paragraph(fmt::format(
      "The cascade by method {}: {} poles in all. Largest error {} dB over all frequencies, {} dB and {} "
      "degrees between {} and {} Hz.",
      a.method, a.sections.pole_count(), text(a.error.everywhere_db, 3), text(a.error.band_db, 3),
      text(a.error.band_deg, 3), text(a.error.band.from.value), text(a.error.band.to.value)));
  if (!a.limit_met) page.warning("The limit that was asked for could not be met at the largest order.");
  Table terms{
      {"term", "beta", "corner ratio", "order", "error everywhere, dB", "limit of any method, dB"}, {}, {}};
  for (const TermApproximation& term : a.terms) {
    terms.rows.push_back({fmt::format("{} - {} Hz", text(term.term.low_corner().hz().value),
                                      text(term.term.high_corner().hz().value)),
                          fmt::format("{:+.4f}", term.term.beta), text(term.term.corner_ratio()),
                          std::to_string(term.order), text(term.error.everywhere_db, 3),
                          term.limit_law_db > 0.0 ? text(term.limit_law_db, 3) : "-"});
  }
  page.table(terms);
  page.table(alternatives_table(in.design),
             "Ways to integer sections (marked: the one that is built). Direct and waveform fits have real "
             "poles and zeros. "
             "Waveform: error of the compensating waveform at the tracked frequencies, % of range.");
  for (const std::string& reason : in.design.passed_over)
    page.paragraph("Passed over, it cannot be built: " + reason);
  Table sections{{"section", "gain", "zeros, rad/s", "poles, rad/s"}, {}, {}};
  const auto roots = [](const std::vector<std::complex<double>>& values) {
    std::vector<std::string> parts;
    for (const auto& root : values) {
      parts.push_back(root.imag() == 0.0
                          ? text(root.real(), 6)
                          : fmt::format("{} {} {}j", text(root.real(), 6), root.imag() < 0 ? "-" : "+",
                                        text(std::abs(root.imag()), 6)));
    }
    return parts.empty() ? std::string("-") : join(parts, ", ");
  };
  int number = 0;
  for (const Section& section : in.design.sections().sections) {
    sections.rows.push_back(
        {std::to_string(++number), text(section.gain, 6), roots(section.zeros), roots(section.poles)});
  }
  page.table(sections,
             fmt::format("H(s) = {} times the product of these", text(in.design.sections().gain, 8)));
}

void budget_chapter(Page& page, const ReportInput& in) {
  page.chapter("Error budget");
  page.figure(
      stages_svg(in.project, in.design, in.budget),
      "Every stage of the way in one plot. The holds of the sampled FPAA chain turn the phase far more than "
      "anything else does; its magnitude stays.");
  Table table{{"stage", "against", "dB", "degrees", "complex, %", "at the points, dB", "waveform rms, %",
               "worst frequency, %"},
              {},
              {}};
  const auto waveform_cells = [](const WaveformError& w) {
    return std::vector<std::string>{fmt::format("{:.3f}", w.rms_percent),
                                    fmt::format("{:.3f}", w.worst_percent)};
  };
  table.rows.push_back({"no rate compensation", "", "", "", "", ""});
  for (const auto& cell : waveform_cells(in.budget.uncompensated)) table.rows.back().push_back(cell);
  table.rows.push_back({fmt::format("best fixed gain, {:.4f}", in.budget.constant_gain), "", "", "", "", ""});
  for (const auto& cell : waveform_cells(in.budget.constant)) table.rows.back().push_back(cell);
  for (const BudgetRow& row : in.budget.rows) {
    if (row.waveform.worst_percent > in.budget.uncompensated.worst_percent)
      table.marked.push_back(table.rows.size());
    const bool first = row.previous.empty();
    table.rows.push_back(
        {row.stage, row.previous, first ? "" : text(row.against_previous.max_magnitude_db, 3),
         first ? "" : text(row.against_previous.max_phase_deg, 3),
         first ? "" : text(row.against_previous.max_complex_percent, 3), text(row.points_max_db, 3)});
    for (const auto& cell : waveform_cells(row.waveform)) table.rows.back().push_back(cell);
  }
  page.table(
      table,
      fmt::format("Each stage against the one before it between {} and {} Hz; and the waveform that it makes "
                  "of the disturbance at the tracked frequencies, in percent of the stage's range. Marked: "
                  "worse than no rate compensation.",
                  text(in.budget.band.from.value), text(in.budget.band.to.value)));
  if (in.budget.magnitude_only_is_worse) {
    page.warning(
        "The magnitude fits, and yet the compensating waveform is worse than with no rate compensation at "
        "all: "
        "the compensator also turns the phase of the waveform and of its harmonics. Fit the waveform itself "
        "instead (bodesmith fit --waveform).");
  }
}

void tracking_chapter(Page& page, const ReportInput& in) {
  page.chapter("Tracking");
  const TrackingStudy& study = in.tracking;
  page.paragraph(
      fmt::format("A {} of full stroke ({} um) through disturbance generator, compensator, amplifier and "
                  "stage, integrated by CVODE "
                  "until it repeats; rms error in percent of the range (eq. 8), as in the paper's Table II. "
                  "Against the exact "
                  "periodic solution the largest difference is {} % of range.",
                  in.project.track.sine ? "sine" : "triangle", text(in.project.plant.stroke_m * 1e6),
                  text(study.largest_cross_check_percent, 2)));
  Table table;
  table.head = {"compensation"};
  for (const Hertz f : study.frequency) table.head.push_back(text(f.value) + " Hz");
  for (const TrackedDesign& design : study.designs) {
    table.rows.push_back({design.name});
    for (const double value : design.rms_percent) table.rows.back().push_back(fmt::format("{:.3f}", value));
  }
  page.table(table, "rms tracking error, % of range");
  Plot plot;
  plot.title = "rms tracking error over the operating frequency";
  plot.x = {"frequency, Hz", true};
  plot.y = {"% of range", true};
  for (const TrackedDesign& design : study.designs)
    plot.series.push_back({design.name, hertz(study.frequency), design.rms_percent});
  page.figure(report::to_svg(plot), "Which choice tracks how well.");
  Plot reference;
  reference.title = fmt::format("One period at {} Hz", text(study.shown.frequency.value));
  reference.x = {"time, s"};
  reference.y = {"reference"};
  reference.height = 200;
  reference.series.push_back(
      {"reference x", study.shown.time_s, study.shown.reference, Series::Style::line, 6});
  Plot error;
  error.title = "Tracking error";
  error.x = {"time, s"};
  error.y = {"% of range"};
  for (size_t i = 0; i < study.shown.error_percent.size(); ++i) {
    if (study.designs[i].key == "none") continue;
    error.series.push_back({study.designs[i].name, study.shown.time_s, study.shown.error_percent[i],
                            Series::Style::line, static_cast<int>(i)});
  }
  page.figure(report::stack_svg({reference, error}),
              "The error without any compensation is left out: it would dwarf the others.");
}

void fpaa_chapter(Page& page, const ReportInput& in) {
  if (!in.design.plan) return;
  const fpaa::Plan& plan = *in.design.plan;
  page.chapter("FPAA");
  page.paragraph(
      fmt::format("{} filter blocks on {} chip(s) of {}. Worst complex error against the sections, gain "
                  "included: {} % between {} and {} Hz; with every hold and half-cycle delay {} %.",
                  plan.cams().size(), plan.chips.size(), plan.board, text(plan.error.max_complex_percent, 3),
                  text(plan.error.band.from.value), text(plan.error.band.to.value),
                  text(plan.error_with_delays.max_complex_percent, 3)));
  page.figure(fpaa::board_picture_svg(plan), "Chips, configurable blocks, wires and what is used of them.");
  Table table{{"CAM", "CAB", "clock, Hz", "capacitors"}, {}, {}};
  for (const fpaa::ChipPlan& chip : plan.chips) {
    for (const fpaa::PlacedCam& cam : chip.cams) {
      std::vector<std::string> capacitors;
      for (const auto& c : cam.capacitors) capacitors.push_back(fmt::format("{} {}", c.name, c.units));
      table.rows.push_back({fmt::format("chip {} {} ({}, {})", chip.chip, cam.name, cam.cam, cam.option),
                            std::to_string(cam.cab), text(cam.clock_a.value, 6), join(capacitors, ", ")});
    }
  }
  page.table(table, "As typed into the designer; the full build sheet lies beside the plan.");
  for (const std::string& note : plan.notes) page.paragraph(note);
  for (const std::string& assumption : plan.assumptions) page.warning("Assumed: " + assumption);
}

void circuit_chapter(Page& page, const ReportInput& in) {
  if (!in.design.circuit) return;
  const Realised& realised = *in.design.circuit;
  page.chapter("Circuit");
  page.paragraph(fmt::format(
      "{} op-amp stages, {} parts ({} resistors, {} capacitors). Against the sections, between {} and {} Hz: "
      "{} dB by the "
      "preferred values ({} dB if each were rounded by itself), {} dB by the op-amps ({}).",
      realised.circuit.stages.size(), realised.circuit.parts.size(), in.project.circuit->resistors,
      in.project.circuit->capacitors, text(realised.report.band.from.value),
      text(realised.report.band.to.value), text(realised.report.parts.max_magnitude_db, 3),
      text(realised.report.nearest.max_magnitude_db, 3), text(realised.report.opamps.max_magnitude_db, 3),
      realised.circuit.model.name));
  if (in.ngspice) {
    page.paragraph(fmt::format(
        "ngspice on the emitted netlist, {} to {} Hz: {} dB from the program's own network solution, "
        "{} dB and {} degrees from the sections.",
        text(in.ngspice->band.from.value), text(in.ngspice->band.to.value),
        text(in.ngspice->against_network.max_magnitude_db, 3),
        text(in.ngspice->against_sections.max_magnitude_db, 3),
        text(in.ngspice->against_sections.max_phase_deg, 3)));
  } else {
    page.warning("ngspice is not installed: the netlist was not run.");
  }
  Table table{{"part", "stage", "series", "wanted", "mounted", "difference, %"}, {}, {}};
  for (const Part& part : realised.circuit.parts) {
    const char* unit = part.kind == Part::Kind::resistor ? "Ω" : "F";
    table.rows.push_back({part.name, std::to_string(part.stage + 1), part.series,
                          engineering_text(part.wanted, unit, 5), engineering_text(part.realised, unit, 5),
                          fmt::format("{:+.2f}", 100.0 * (part.realised / part.wanted - 1.0))});
  }
  page.table(table);
  for (const std::string& warning : realised.report.warnings) page.warning(warning);
}

void layout_chapter(Page& page, const ReportInput& in) {
  page.chapter("Disturbance generator");
  const DisturbanceLayout& layout = in.design.layout;
  page.paragraph(fmt::format(
      "{} multipliers ({}) make the powers that the branches share; {} summing op-amps; a switch driven by "
      "the slope of "
      "the reference picks the branch. Largest error of d by the preferred resistors: {} % of range.",
      layout.multipliers.size(), layout.multiplier.name, layout.branches.size(),
      text(layout.max_error_percent, 3)));
  page.figure(layout_drawing(layout), "Powers, weighted sums, branch switch.");
  for (const std::string& warning : layout.warnings) page.warning(warning);
}

void origin_chapter(Page& page, const ReportInput& in) {
  page.chapter("Where this comes from");
  Table table{{"input", "SHA-256"}, {}, {}};
  for (const InputFile& file : in.from.inputs) table.rows.push_back({file.path, file.sha256});
  page.table(table);
}

}  // namespace

std::string stages_svg(const Project& project, const Design& design, const Budget& budget) {
  const Band band{Hertz{budget.band.from.value / 10.0}, Hertz{budget.band.to.value * 10.0}};
  const std::vector<Hertz> grid = log_grid(band, 241);
  Plot magnitude;
  magnitude.title = "Magnitude";
  magnitude.x = {"frequency, Hz", true};
  magnitude.y = {"dB"};
  Plot phase = magnitude;
  phase.title = "Phase";
  phase.y = {"degrees"};
  int color = 0;
  for (const DesignStage& stage : design_stages(design)) {
    // Sampled responses are shown up to a quarter of what could be a useful band, where images do not hide
    // the plot.
    Series db{
        stage.name, hertz(grid), {}, color % 2 == 0 ? Series::Style::line : Series::Style::dashed, color};
    Series degrees = db;
    double last = 0.0;
    for (const Hertz f : grid) {
      const std::complex<double> h = stage.response(f.rad_s());
      db.y.push_back(to_decibel(std::abs(h)));
      double angle = to_degrees(std::arg(h));
      angle += 360.0 * std::round((last - angle) / 360.0);
      last = angle;
      degrees.y.push_back(angle);
    }
    magnitude.series.push_back(db);
    phase.series.push_back(degrees);
    ++color;
  }
  magnitude.series.push_back(wanted_points(project));
  // What lies far outside (the notches of a sampled chain) must not flatten the curves that matter.
  double low = 0.0;
  double high = 0.0;
  for (const double y : magnitude.series.front().y) {
    low = std::min(low, y);
    high = std::max(high, y);
  }
  magnitude.y.fixed = true;
  magnitude.y.from = low - 0.25 * std::max(0.5, high - low);
  magnitude.y.to = high + 0.25 * std::max(0.5, high - low);
  double phase_high = 5.0;
  double phase_low = -5.0;
  for (const double y : phase.series.front().y) {
    phase_high = std::max(phase_high, y);
    phase_low = std::min(phase_low, y);
  }
  phase.y.fixed = true;
  phase.y.from = 2.0 * phase_low;
  phase.y.to = 1.5 * phase_high;
  return report::stack_svg({magnitude, phase});
}

std::string report_page(const ReportInput& in) {
  Page page(in.project.name,
            "From the wanted magnitude to checked hardware: what was asked, what each step kept of it.");
  page.chapter("Summary");
  std::vector<std::pair<std::string, std::string>> key;
  if (in.design.fit.cascade.fit) {
    key.emplace_back(fmt::format("{:.1e} dB", in.design.fit.cascade.fit->max_db),
                     "largest miss of the cascade at the points");
  }
  key.emplace_back(
      text(in.design.approximation.error.everywhere_db, 3) + " dB",
      fmt::format("sections against cascade, {} poles", in.design.approximation.sections.pole_count()));
  if (in.design.plan)
    key.emplace_back(text(in.design.plan->error.max_complex_percent, 3) + " %",
                     "FPAA plan against sections, complex");
  if (in.design.circuit) {
    key.emplace_back(text(in.design.circuit->report.parts.max_magnitude_db, 3) + " dB",
                     "circuit's parts against sections");
  }
  page.key_figures(key);
  Table limits{{"limit", "asked", "got", ""}, {}, {}};
  for (const LimitCheck& check : in.limits) {
    if (!check.met()) limits.marked.push_back(limits.rows.size());
    limits.rows.push_back(
        {check.name, text(check.limit), text(check.got, 3), check.met() ? "met" : "missed"});
  }
  if (!limits.rows.empty()) page.table(limits);
  for (const std::string& finding : in.tracking.findings) page.warning(finding);

  wish_chapter(page, in);
  fit_chapter(page, in);
  sections_chapter(page, in);
  budget_chapter(page, in);
  tracking_chapter(page, in);
  fpaa_chapter(page, in);
  circuit_chapter(page, in);
  layout_chapter(page, in);
  origin_chapter(page, in);
  return page.html();
}

}  // namespace bodesmith::project
