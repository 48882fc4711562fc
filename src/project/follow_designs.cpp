#include "project/follow_designs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "project/tracked_plant.hpp"
#include "project/tracking_findings.hpp"

namespace bodesmith::project {
namespace {

TrackedDesign tracked_design(const TrackedCandidate& candidate, const std::vector<Hertz>& frequencies,
                             const tracking::Report& report) {
  TrackedDesign out;
  out.key = candidate.key;
  out.name = candidate.design.name;
  out.built = candidate.built;
  out.parts = candidate.parts;
  for (const Hertz f : frequencies) {
    const tracking::Case* found = report.find(f, out.name);
    out.rms_percent.push_back(found->rms_percent);
    out.max_percent.push_back(found->max_percent);
    out.rms_percent_without_lag.push_back(found->rms_percent_without_lag);
    out.lag_s.push_back(found->lag_s);
    out.on_reference_percent.push_back(found->on_reference_percent.value());
  }
  return out;
}

/// Largest difference between CVODE and the harmonic computation. The images of a clocked chain are not in the
/// latter: there the difference is no error of either.
double max_cross_check(const tracking::Report& report) {
  double out = 0.0;
  for (const tracking::Case& one : report.cases) {
    if (one.method != tracking::Method::cvode || !one.check) continue;
    out = std::max(out, one.check->difference_percent);
  }
  return out;
}

/// One period at the highest frequency.
TrackedPeriod shown_period(const tracking::Report& report, const std::vector<TrackedCandidate>& candidates,
                           const std::vector<Hertz>& frequencies, double stroke) {
  TrackedPeriod out;
  out.frequency = *std::max_element(frequencies.begin(), frequencies.end());
  for (const TrackedCandidate& candidate : candidates) {
    const tracking::Case* found = report.find(out.frequency, candidate.design.name);
    if (out.time_s.empty()) {
      out.time_s = found->time_s;
      for (const double r : found->reference) out.reference.push_back(r / stroke);
    }
    std::vector<double> error;
    for (std::size_t i = 0; i < found->displacement.size(); ++i) {
      error.push_back(100.0 * (found->displacement[i] - found->reference[i]) / stroke);
    }
    out.error_percent.push_back(std::move(error));
  }
  return out;
}

/// Of what the run writes the design that tracks best at its worst frequency; of those that differ by less than 1 %
/// of that the one with the fewest parts. Where the project chose by something else, the disturbance paper's one
/// pass through the hardware at hand.
std::string as_built_key(const Project& project, const TrackingStudy& study) {
  if (project.choice != Project::Choice::tracking) {
    for (const std::string_view key : {tracked::circuit, tracked::fpaa_with_holds})
      if (study.find(key) != nullptr) return std::string(key);
    return std::string(tracked::sections);
  }
  const TrackedDesign* best = nullptr;
  for (const TrackedDesign& design : study.designs) {
    if (!design.built) continue;
    const double worst = design.worst_without_lag_percent();
    const double to_beat = best == nullptr ? INFINITY : best->worst_without_lag_percent();
    const bool tie = std::abs(worst - to_beat) <= 0.01 * to_beat;
    if (best == nullptr || (tie ? design.parts < best->parts : worst < to_beat)) best = &design;
  }
  return best == nullptr ? std::string(tracked::sections) : best->key;
}

}  // namespace

tracking::Report follow_designs(const Project& project, const std::vector<TrackedCandidate>& candidates) {
  std::vector<tracking::Design> designs;
  for (const TrackedCandidate& candidate : candidates) designs.push_back(candidate.design);
  tracking::Options options = tracking_options(project);
  options.also_on_reference = true;
  options.relative_tolerance = 5e-7;  // a repeat is settled within 2e-5 of the stroke
  return tracking::track(tracking_plant(project), designs, options);
}

TrackingStudy tracking_study(const Project& project, const Design& design, const Budget& budget,
                             const std::vector<TrackedCandidate>& candidates, const tracking::Report& report,
                             const ControllersTracked& controllers, std::vector<TrackedElsewhere> elsewhere) {
  TrackingStudy study;
  study.frequency = project.track.frequency;
  study.waveform = project.track.waveform();
  study.amplitude = project.track.amplitude();
  for (const TrackedCandidate& candidate : candidates)
    study.designs.push_back(tracked_design(candidate, study.frequency, report));
  study.max_cross_check_percent = max_cross_check(report);
  study.shown = shown_period(report, candidates, study.frequency, tracking_plant(project).stroke);
  study.designs.insert(study.designs.end(), controllers.here.begin(), controllers.here.end());
  study.as_built = as_built_key(project, study);
  study.elsewhere = std::move(elsewhere);
  study.findings = tracking_findings(project, design, budget, candidates, report, study);
  return study;
}

TrackingStudy study_tracking(const Project& project, const Design& design, const Budget& budget) {
  const std::vector<TrackedCandidate> candidates = tracked_candidates(project, design);
  const ControllersTracked none = track_controllers(project, {});
  return tracking_study(project, design, budget, candidates, follow_designs(project, candidates), none,
                        tracked_elsewhere(project, candidates, none));
}

}  // namespace bodesmith::project
