#include "project/run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "project/tracking/engines.hpp"

namespace bodesmith::project {
namespace {

std::string target_text(const Run& run) {
  const Project::Target& target = run.project.target;
  return fmt::format("target     {}, {}\n           {}\n", target.file, span_text(target.band),
                     run.design.how);
}

std::string sections_text(const Run& run) {
  const Design& design = run.design;
  const Alternative& built = design.built();
  if (!run.project.plant) {
    return fmt::format("sections   {} poles{}\n", built.sections.pole_count(),
                       run.project.target.sections
                           ? ""
                           : fmt::format(", {} dB from the target", rounded_text(built.points_max_db, 3)));
  }
  return fmt::format("cascade    {} terms, largest error at the points {:.1e} dB\n",
                     design.fit->cascade.terms.size(), design.fit->cascade.fit->max_db) +
         (built.kind == Alternative::Kind::cascade
              ? fmt::format("sections   {} poles, at most {} dB from the cascade at any frequency\n",
                            built.sections.pole_count(),
                            rounded_text(design.approximation->error.everywhere_db, 3))
              : fmt::format("sections   {}: {} dB at the points\n", built.name,
                            rounded_text(built.points_max_db, 3)));
}

std::string hardware_text(const Run& run) {
  const Design& design = run.design;
  std::string out;
  if (design.plan) {
    const fpaa::PlanError& runs = design.plan->error_with_delays;
    out += fmt::format("fpaa       {} CAMs, {} % as the board runs\n", design.plan->cams().size(),
                       rounded_text(runs.max_complex_percent, 3));
  } else if (!design.no_plan.empty()) {
    out += "fpaa       NOT made: " + design.no_plan + "\n";
  }
  if (design.circuit) {
    const synthesis::Candidate& best = design.circuit->best;
    out += fmt::format("circuit    {}, {} op-amps, {} dB with parts and op-amps", best.how,
                       best.made.circuit.opamps.size(), rounded_text(best.judged.max_magnitude_db, 3));
    if (run.ngspice)
      out += fmt::format(", {} by ngspice", rounded_text(run.ngspice->against_sections.max_magnitude_db, 3));
    else if (run.project.plant)
      out += "; not simulated: ngspice is not installed";
    out += "\n";
    for (const std::string& shortfall : best.shortfalls) out += "           NOT met: " + shortfall + "\n";
  }
  if (design.yield) {
    out += fmt::format("tolerances 95 of 100 circuits within {} dB ({} % resistors, {} % capacitors)\n",
                       rounded_text(design.yield->worst_db.quantile(0.95), 3),
                       rounded_text(run.project.spread.resistor_percent),
                       rounded_text(run.project.spread.capacitor_percent));
  }
  if (design.layout)
    out += fmt::format("layout     {} multipliers, d within {} % of range\n",
                       design.layout->generator_multipliers(),
                       rounded_text(design.layout->max_error_percent, 3));
  return out;
}

/// The first lines: what was tracked as built and what stands alongside it, and what is built by every engine that there is.
std::string headline_text(const Run& run) {
  const TrackingStudy& study = run.tracking;
  return text_of(fmt::format("tracked    worst rms error, % of range, {} {}", to_string(study.waveform),
                             frequency_span(study)),
                 headline_table(run.project, study)) +
         (study.engines.empty() ? "" : text_of("checked    delay removed, by", engine_table(study.engines)));
}

std::string elsewhere_text(const TrackingStudy& tracking) {
  if (tracking.elsewhere.empty()) return {};
  std::string out =
      "           worst over the frequencies on other stages and references, pure delay removed (the model's own fit):\n";
  for (const TrackedElsewhere& one : tracking.elsewhere) {
    std::string line =
        fmt::format("  {}, {} {}:", one.stage, to_string(one.waveform), rounded_text(one.amplitude));
    for (const TrackedDesign& design : one.designs)
      line += fmt::format("{} {} {:.2f}", &design == &one.designs.front() ? "" : ";", design.key,
                          design.worst_without_lag_percent());
    // Keys of the CSV, as words.
    std::replace(line.begin(), line.end(), '_', ' ');
    out += line;
    if (!one.fit_percent.empty())
      out += fmt::format(" (fit {:.2f})", *std::ranges::max_element(one.fit_percent));
    out += "\n";
  }
  return out;
}

}  // namespace

bool Run::limits_met() const {
  return shortfalls().empty() &&
         std::ranges::all_of(limits, [](const LimitCheck& check) { return check.met(); });
}

std::vector<std::string> Run::shortfalls() const {
  std::vector<std::string> out;
  if (design.circuit) out = design.circuit->best.shortfalls;
  if (!design.no_plan.empty()) out.push_back(design.no_plan);
  return out;
}

std::string Run::summary(const std::filesystem::path& folder) const {
  std::string out = project.name + "\n";
  if (project.plant) {
    out += "built      " + design.built().name + "\n" + headline_text(*this);
    for (const std::string& warning : engine_warnings(tracking.engines))
      out += "warning    " + warning + "\n";
  } else {
    out += target_text(*this) + sections_text(*this);
  }
  out += hardware_text(*this);
  for (const std::string& one : not_tried) out += "not tried in the time given: " + one + "\n";
  out += limits_text(limits);
  if (!project.plant) return out + fmt::format("look at    {}\n", (folder / "report.html").string());
  return out +
         fmt::format(
             "look at    {} (everything as a page)\n           {} (alternatives, every frequency, {} notes)\n",
             (folder / "report.html").string(), (folder / "summary.txt").string(), tracking.findings.size());
}

std::string Run::tables() const {
  std::string out = project.name + "\n" + headline_text(*this) + sections_text(*this) +
                    text_of("           alternatives (*: built)", alternatives_table(design));
  for (const std::string& reason : design.passed_over) out += "           cannot be built: " + reason + "\n";
  out += hardware_text(*this) +
         text_of("tracking   rms error, % of range (*: built), at", tracking_table(tracking)) +
         elsewhere_text(tracking);
  for (const std::string& finding : tracking.findings) out += "note: " + finding + "\n";
  return out + limits_text(limits);
}

}  // namespace bodesmith::project
