#include "project/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "project/tracking/engines.hpp"

namespace bodesmith::project {
namespace {

std::string synthesis_text(const Design& design) {
  std::string out;
  if (design.fit.cascade.fit) {
    out += fmt::format("cascade    {} terms, largest error at the points {:.1e} dB\n",
                       design.fit.cascade.terms.size(), design.fit.cascade.fit->max_db);
  }
  if (design.built().kind == Alternative::Kind::cascade) {
    out += fmt::format("sections   {} poles, at most {} dB from the cascade at any frequency\n",
                       design.approximation.sections.pole_count(),
                       rounded_text(design.approximation.error.everywhere_db, 3));
  } else {
    out += fmt::format("sections   {}: {} dB at the points\n", design.built().name,
                       rounded_text(design.built().points_max_db, 3));
  }
  return out;
}

std::string alternatives_text(const Design& design) {
  std::string out =
      "           alternatives (*: built): poles, error at the points in dB, worst waveform error, worst error tracked "
      "self-fed in % of range, gain above the band\n";
  for (std::size_t i = 0; i < design.alternatives.size(); ++i) {
    const Alternative& a = design.alternatives[i];
    out += fmt::format(
        "         {} {:<22} {:>2} {:>9} {:>7.3f} {:>8} {:>7.2f} dB\n", i == design.chosen ? "*" : " ", a.name,
        a.sections.pole_count(), rounded_text(a.points_max_db, 2), a.waveform.worst_percent,
        std::isfinite(a.tracked_percent) ? fmt::format("{:.3f}", a.tracked_percent) : "diverges",
        a.above_band_db);
  }
  for (const std::string& reason : design.passed_over) out += "           cannot be built: " + reason + "\n";
  return out;
}

std::string hardware_text(const ProjectRun& run) {
  std::string out;
  if (run.design.plan) {
    const fpaa::Plan& plan = *run.design.plan;
    out += fmt::format("fpaa       {} CAMs, worst complex error {} % as the board runs ({} to {} Hz)\n",
                       plan.cams().size(), rounded_text(plan.error_with_delays.max_complex_percent, 3),
                       rounded_text(plan.error_with_delays.band.from.value),
                       rounded_text(plan.error_with_delays.band.to.value));
  }
  if (run.design.circuit) {
    const synthesis::Realised& realised = run.design.realised();
    out += fmt::format("circuit    {} stages, {} dB by its parts", realised.circuit.stages.size(),
                       rounded_text(realised.report.parts.max_magnitude_db, 3));
    out += run.ngspice ? fmt::format(", ngspice {} dB from the sections\n",
                                     rounded_text(run.ngspice->against_sections.max_magnitude_db, 3))
                       : std::string("; not simulated: ngspice is not installed\n");
  }
  const generator::Layout& layout = run.design.layout;
  out += fmt::format("layout     {} multipliers, d within {} % of range\n", layout.generator_multipliers(),
                     rounded_text(layout.max_error_percent, 3));
  return out;
}

/// The first lines: what was tracked as built, and what stands beside it.
std::string headline_text(const ProjectRun& run) {
  const TrackingStudy& study = run.tracking;
  std::string out = fmt::format("{:<72}{:>9} {:>14}\n",
                                fmt::format("tracked    worst rms error, % of range, {} {}",
                                            to_string(study.waveform), frequency_span(study)),
                                "as it is", "delay removed");
  for (const HeadlineRow& row : headline(run.project, study)) {
    const std::string plain =
        row.as_it_is_percent ? fmt::format("{:.3f}", *row.as_it_is_percent) : std::string();
    out += fmt::format("  {:<70}{:>9} {:>14}\n", row.what, plain, row.without_lag);
  }
  return out;
}

/// What is built, by every engine that there is.
std::string engines_text(const TrackingStudy& study) {
  std::string out;
  for (const std::vector<std::string>& row : engine_table(study.engines)) {
    out += fmt::format("{:<46}{:>13}{:>10}{:>10}{:>10}\n",
                       out.empty() ? "checked    delay removed, by" : "  " + row[0], row[1], row[2], row[3],
                       row[4]);
  }
  return study.engines.empty() ? "" : out;
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
      out += fmt::format(" (fit {:.2f})", *std::max_element(one.fit_percent.begin(), one.fit_percent.end()));
    out += "\n";
  }
  return out;
}

std::string tracking_text(const TrackingStudy& tracking) {
  std::string out = "tracking   rms error, % of range (*: built), at";
  for (const Hertz f : tracking.frequency) out += fmt::format(" {:>8}", rounded_text(f.value));
  out += " Hz\n";
  for (const TrackedDesign& tracked : tracking.designs) {
    out += fmt::format(" {}{:<45}", tracked.built ? "*" : " ", tracked.name);
    for (const tracking::TrackingError& one : tracked.at) out += fmt::format(" {:>8.3f}", one.rms_percent);
    out += "\n";
  }
  out += elsewhere_text(tracking);
  for (const std::string& finding : tracking.findings) out += "note: " + finding + "\n";
  return out;
}

}  // namespace

bool Run::limits_met() const {
  return shortfalls().empty() &&
         std::all_of(limits.begin(), limits.end(), [](const LimitCheck& check) { return check.met(); });
}

std::vector<std::string> ProjectRun::shortfalls() const {
  return design.circuit ? design.circuit->best.shortfalls : std::vector<std::string>();
}

std::string ProjectRun::summary(const std::filesystem::path& folder) const {
  std::string out = fmt::format("{}\nbuilt      {}\n", project.name, design.built().name) +
                    headline_text(*this) + engines_text(tracking) + hardware_text(*this);
  for (const std::string& shortfall : shortfalls()) out += "           NOT met: " + shortfall + "\n";
  for (const std::string& one : not_tried) out += "not tried in the time given: " + one + "\n";
  return out + limits_text(limits) +
         fmt::format(
             "look at    {} (everything as a page)\n           {} (alternatives, every frequency, {} notes)\n",
             (folder / "report.html").string(), (folder / "summary.txt").string(), tracking.findings.size());
}

std::string ProjectRun::tables() const {
  return project.name + "\n" + headline_text(*this) + engines_text(tracking) + synthesis_text(design) +
         alternatives_text(design) + hardware_text(*this) + tracking_text(tracking) + limits_text(limits);
}

}  // namespace bodesmith::project
