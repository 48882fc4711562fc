#include "project/tracking_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "numeric/parallel_for.hpp"
#include "project/tracked_designs.hpp"
#include "project/tracked_plant.hpp"
#include "project/tracking_elsewhere.hpp"
#include "project/tracking_findings.hpp"
#include "tracking/track.hpp"

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

double TrackedDesign::worst_percent() const {
  return *std::max_element(rms_percent.begin(), rms_percent.end());
}

double TrackedDesign::worst_without_lag_percent() const {
  return *std::max_element(rms_percent_without_lag.begin(), rms_percent_without_lag.end());
}

const TrackedDesign* TrackingStudy::find(std::string_view key) const {
  const auto found = std::find_if(designs.begin(), designs.end(),
                                  [key](const TrackedDesign& design) { return design.key == key; });
  return found == designs.end() ? nullptr : &*found;
}

TrackingStudy study_tracking(const Project& project, const Design& design, const Budget& budget,
                             const ControllersLater& controllers) {
  const Stopwatch watch;
  const std::vector<TrackedCandidate> candidates = tracked_candidates(project, design);
  std::vector<tracking::Design> designs;
  for (const TrackedCandidate& candidate : candidates) designs.push_back(candidate.design);
  // Other stages wait for the controllers: they are followed beside the project's own one.
  struct OnOthers {
    ControllersTracked built;
    std::vector<TrackedElsewhere> elsewhere;
  };
  auto on_others = std::async(std::launch::async, [&] {
    OnOthers out{controllers ? controllers() : track_controllers(project, {}), {}};
    if (!project.deadline.passed()) out.elsewhere = tracked_elsewhere(project, candidates, out.built);
    return out;
  });
  const tracking::Plant plant = tracking_plant(project);
  tracking::Options options = tracking_options(project);
  options.also_on_reference = true;
  options.relative_tolerance = 5e-7;  // a repeat is settled within 2e-5 of the stroke
  const tracking::Report report = tracking::track(plant, designs, options);

  TrackingStudy study;
  study.frequency = project.track.frequency;
  study.waveform = project.track.waveform();
  study.amplitude = project.track.amplitude();
  for (const TrackedCandidate& candidate : candidates)
    study.designs.push_back(tracked_design(candidate, study.frequency, report));
  study.max_cross_check_percent = max_cross_check(report);
  study.shown = shown_period(report, candidates, study.frequency, plant.stroke);
  OnOthers others = on_others.get();
  for (TrackedDesign& one : others.built.here) study.designs.push_back(std::move(one));
  study.as_built = as_built_key(project, study);
  study.elsewhere = std::move(others.elsewhere);
  study.findings = tracking_findings(project, design, budget, candidates, report, study);
  study.compute_s = watch.seconds();
  return study;
}

std::string frequency_span(const TrackingStudy& study) {
  const auto [low, high] = std::minmax_element(study.frequency.begin(), study.frequency.end());
  if (low == high) return rounded_text(low->value) + " Hz";
  return fmt::format("{} to {} Hz", rounded_text(low->value), rounded_text(high->value));
}

std::vector<HeadlineRow> headline(const Project& project, const TrackingStudy& study) {
  std::vector<HeadlineRow> out;
  const auto add = [&](const std::string& what, const TrackedDesign* design) {
    if (design == nullptr) return;
    out.push_back(
        {what, design->worst_percent(), fmt::format("{:.3f}", design->worst_without_lag_percent())});
  };
  const TrackedDesign* built = study.find(study.as_built);
  add("as built: " + (built == nullptr ? std::string() : built->name), built);
  add("without compensation", study.find(tracked::none));
  add("the paper's design: one pass, ideal cascade", study.find(tracked::cascade));
  const std::vector<double>& measured = project.track.measured_percent;
  if (!measured.empty()) {
    const auto [low, high] = std::minmax_element(measured.begin(), measured.end());
    out.push_back(
        {"measured on the paper's stage", std::nullopt, fmt::format("{:.2f} to {:.2f}", *low, *high)});
  }
  return out;
}

}  // namespace bodesmith::project
