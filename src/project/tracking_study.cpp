#include "project/tracking_study.hpp"

#include <algorithm>

#include "project/tracked_designs.hpp"
#include "project/tracking_findings.hpp"
#include "tracking/track.hpp"

namespace bodesmith::project {
namespace {

tracking::Options tracking_options(const Project& project) {
  using Reference = tracking::Options::Reference;
  tracking::Options options;
  options.frequencies = project.track.frequency;
  // A compensator stands in the path of its own branch; the switch selects behind it (disturbance paper,
  // Fig. 2).
  options.place = tracking::Options::Place::before_switch;
  options.reference =
      project.track.waveform == Project::Waveform::sine ? Reference::sine : Reference::triangle;
  return options;
}

TrackedDesign tracked_design(const TrackedCandidate& candidate, const std::vector<Hertz>& frequencies,
                             const tracking::Report& report) {
  TrackedDesign out;
  out.stage = candidate.stage;
  out.name = candidate.design.name;
  for (const Hertz f : frequencies) {
    const tracking::Case* found = report.find(f, out.name);
    out.rms_percent.push_back(found->rms_percent);
    out.max_percent.push_back(found->max_percent);
    out.rms_percent_without_lag.push_back(found->rms_percent_without_lag);
    out.lag_s.push_back(found->lag_s);
  }
  return out;
}

/// Largest difference between CVODE and the exact periodic solution. The images of a clocked chain are not in the
/// harmonic computation: there the difference is no error of either.
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

}  // namespace

std::string_view to_string(TrackedStage stage) {
  switch (stage) {
    case TrackedStage::none:
      return "none";
    case TrackedStage::polynomial:
      return "polynomial";
    case TrackedStage::cascade:
      return "cascade";
    case TrackedStage::sections:
      return "sections";
    case TrackedStage::waveform:
      return "waveform";
    case TrackedStage::scheduled:
      return "scheduled";
    case TrackedStage::fpaa:
      return "fpaa";
    case TrackedStage::fpaa_with_holds:
      return "fpaa_with_holds";
    case TrackedStage::circuit:
      return "circuit";
  }
  return "";
}

const TrackedDesign* TrackingStudy::find(TrackedStage stage) const {
  const auto found = std::find_if(designs.begin(), designs.end(),
                                  [stage](const TrackedDesign& design) { return design.stage == stage; });
  return found == designs.end() ? nullptr : &*found;
}

TrackingStudy study_tracking(const Project& project, const Design& design, const Budget& budget) {
  const std::vector<TrackedCandidate> candidates = tracked_candidates(project, design);
  std::vector<tracking::Design> designs;
  for (const TrackedCandidate& candidate : candidates) designs.push_back(candidate.design);
  const tracking::Plant plant = tracking_plant(project);
  const tracking::Report report = tracking::track(plant, designs, tracking_options(project));

  TrackingStudy study;
  study.frequency = project.track.frequency;
  study.compute_s = report.compute_s;
  for (const TrackedCandidate& candidate : candidates) {
    study.designs.push_back(tracked_design(candidate, study.frequency, report));
  }
  study.max_cross_check_percent = max_cross_check(report);
  study.shown = shown_period(report, candidates, study.frequency, plant.stroke);
  study.findings = tracking_findings(project, design, budget, candidates, report, study);
  return study;
}

}  // namespace bodesmith::project
