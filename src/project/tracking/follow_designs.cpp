#include "project/tracking/follow_designs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/text.hpp"
#include "project/tracking/tracked_plant.hpp"

namespace bodesmith::project {
namespace {

using Findings = std::vector<std::string>;
using Shape = tracking::Reference::Shape;

/// "1, 10 and 100 Hz"; "12 frequencies from 1 to 5000 Hz" when there are many.
std::string frequency_list(const std::vector<Hertz>& frequencies) {
  if (frequencies.size() > 6) {
    const auto [low, high] = std::minmax_element(frequencies.begin(), frequencies.end());
    return fmt::format("{} frequencies from {} to {} Hz", frequencies.size(), rounded_text(low->value),
                       rounded_text(high->value));
  }
  std::vector<std::string> parts;
  for (const Hertz f : frequencies) parts.push_back(rounded_text(f.value));
  std::string last = parts.back();
  parts.pop_back();
  return (parts.empty() ? last : join(parts, ", ") + " and " + last) + " Hz";
}

/// Where the first is more than 2 % worse. Pure delay is not the compensator's doing: figures without it.
std::vector<Hertz> worse_at(const TrackingStudy& study, const TrackedDesign& first,
                            const TrackedDesign& second) {
  std::vector<Hertz> out;
  for (std::size_t i = 0; i < study.frequency.size(); ++i)
    if (first.at[i].rms_percent_without_lag > 1.02 * second.at[i].rms_percent_without_lag)
      out.push_back(study.frequency[i]);
  return out;
}

/// The magnitude is met, and yet the waveform may get worse.
Findings cascade_worse_than_constant(const Budget& budget, const TrackingStudy& study) {
  const TrackedDesign &first = *study.find(tracked::cascade), &second = *study.find(tracked::polynomial);
  const std::vector<Hertz> worse = worse_at(study, first, second);
  if (worse.empty()) return {};
  const auto without_lag = &tracking::TrackingError::rms_percent_without_lag;
  const std::vector<double> cascade = first.each(without_lag), constant = second.each(without_lag);
  std::size_t worst = 0;
  for (std::size_t i = 0; i < cascade.size(); ++i)
    if (cascade[i] - constant[i] > cascade[worst] - constant[worst]) worst = i;
  Findings out = {fmt::format(
      "Magnitude-only compensation is worse than the constant polynomial at {} ({} % of range rms instead of "
      "{} % at {} Hz, pure delay removed): it meets the gain at the fundamental, but shifts the phase of a "
      "waveform that has harmonics. Fit the waveform instead.",
      frequency_list(worse), rounded_text(cascade[worst], 3), rounded_text(constant[worst], 3),
      rounded_text(study.frequency[worst].value))};
  if (budget.magnitude_only_is_worse) {
    out.push_back(fmt::format(
        "Over all tracked frequencies the error of the cascade's compensating waveform is {} % of range at worst; "
        "it is {} % without any rate compensation and {} % with the best fixed gain.",
        rounded_text(budget.rows.front().waveform.worst_percent, 3),
        rounded_text(budget.uncompensated.worst_percent, 3), rounded_text(budget.constant.worst_percent, 3)));
  }
  return out;
}

/// The stage adds d of its drive: how much subtracting d of the reference leaves, and the loop.
Findings what_the_drive_changes(const TrackingStudy& study) {
  const TrackedDesign* one = study.find(tracked::polynomial);
  const TrackedDesign* loop = study.find(tracked::self_fed_scheduled);
  if (loop == nullptr) loop = study.find(tracked::self_fed);
  if (one == nullptr || loop == nullptr) return {};
  return {fmt::format(
      "The stage reads its drive: v = r - d(r) leaves {} % of range rms at {} Hz, where an evaluation of the stage on the "
      "reference says {} %. The generator fed by its own drive, v = r - d(v), takes no more multipliers and leaves "
      "{} % there.",
      rounded_text(one->at.front().rms_percent, 3), rounded_text(study.frequency.front().value),
      rounded_text(one->on_reference_percent.front(), 2), rounded_text(loop->at.front().rms_percent, 2))};
}

/// A filter shifts the phase whatever its order; a gain driven by the frequency does not.
Findings what_a_schedule_would_do(const TrackingStudy& study) {
  const TrackedDesign* scheduled = study.find(tracked::self_fed_scheduled);
  const TrackedDesign* filter = study.find(tracked::self_fed_sections);
  if (scheduled == nullptr || filter == nullptr) return {};
  const double with = scheduled->worst_without_lag_percent();
  const double without = filter->worst_without_lag_percent();
  if (with > 0.5 * without) return {};
  return {fmt::format(
      "A gain set by the frequency does better than the linear filter: {} % of range rms at worst (pure delay "
      "removed), against {} % with '{}'.",
      rounded_text(with, 3), rounded_text(without, 3), filter->name)};
}

/// What each way to follow the rate takes for granted where the reference is not a triangle.
Findings what_is_assumed(const Project& project) {
  Findings out;
  for (const Shape shape : project.track.waveforms) {
    if (shape == Shape::triangle) continue;
    const char* slope = "";
    if (shape == Shape::sine)
      slope =
          "the mean of the measured |slope| over some periods is that of a triangle of the same frequency";
    if (shape == Shape::two_tone)
      slope =
          "the mean of the measured |slope| takes the inner turns for a higher frequency than the fundamental's";
    if (shape == Shape::decaying_triangle)
      slope = "the measured |slope| shrinks with the strokes and is taken for a lower frequency";
    out.push_back(fmt::format(
        "Reference {}: the stage's rate gains are those of its fundamental, the amplitude is known; a gain by the known "
        "frequency assumes that the period is, a filter only that it was designed for such a slope; {}.",
        to_string(shape), slope));
    if (shape != Shape::sine && !project.target.disturbance.amplitude.alpha.empty() &&
        std::ranges::min(project.track.amplitudes) < 1.0) {
      out.back() +=
          " Amplitude gains are those of the last peak, which behind an inner turn is not the stroke: partial strokes are followed the worse "
          "for it, as their rows say.";
    }
  }
  return out;
}

/// Where what is built is worse than the polynomial at constant gain.
Findings worse_than_constant(const TrackingStudy& study) {
  const TrackedDesign* built = study.find(study.as_built);
  const TrackedDesign* constant = study.find(tracked::polynomial);
  if (built == nullptr || constant == nullptr || built == constant) return {};
  const std::vector<Hertz> worse = worse_at(study, *built, *constant);
  if (worse.empty()) return {};
  return {fmt::format("As built ('{}') the stage tracks worse than with the constant polynomial at {}.",
                      built->name, frequency_list(worse))};
}

/// Along the project's other references on its own stage: where what is built is worse than nothing.
Findings worse_than_nothing(const TrackingStudy& study) {
  std::vector<std::string> where;
  for (const TrackedElsewhere& one : study.elsewhere) {
    if (one.stage != "polynomial") continue;
    const auto of = [&](std::string_view key) {
      const auto found = std::ranges::find(one.designs, key, &TrackedDesign::key);
      return found == one.designs.end() ? NAN : found->worst_without_lag_percent();
    };
    if (const double built = of(study.as_built), none = of(tracked::none); built > none)
      where.push_back(fmt::format("{} at {} of the stroke ({} % of range for {})", to_string(one.waveform),
                                  rounded_text(one.amplitude), rounded_text(built, 2),
                                  rounded_text(none, 2)));
  }
  if (where.empty()) return {};
  return {fmt::format(
      "As built the stage tracks worse than without compensation: {}; a full stroke's gains are another stroke's only "
      "by an `amplitude` table in the disturbance.",
      join(where, ", "))};
}

/// At which step most accuracy is lost: rms change of the compensating waveform from one design to the next.
Findings largest_loss(const std::vector<TrackedCandidate>& candidates, const tracking::Report& report,
                      const TrackingStudy& study) {
  const tracking::Case* largest = nullptr;
  const TrackedCandidate* step = nullptr;
  for (const TrackedCandidate& candidate : candidates) {
    if (candidate.design.made_from.empty()) continue;
    for (const Hertz f : study.frequency) {
      const tracking::Case* found = report.find(f, candidate.design.name);
      if (largest == nullptr || found->lost_rms_percent > largest->lost_rms_percent) {
        largest = found;
        step = &candidate;
      }
    }
  }
  if (largest == nullptr) return {};
  return {fmt::format(
      "Most accuracy is lost from '{}' to '{}': the compensating waveform changes by {} % of range rms "
      "at {} Hz.",
      step->design.made_from, step->design.name, rounded_text(largest->lost_rms_percent, 3),
      rounded_text(largest->frequency.value))};
}

Findings beyond_the_known_gains(const Project& project, const TrackingStudy& study) {
  const std::vector<Hertz>& known = project.target.disturbance.rate.frequency;
  if (known.empty()) return {};
  std::vector<Hertz> beyond;
  for (const Hertz f : study.frequency) {
    if (f.value > 1.001 * known.back().value) beyond.push_back(f);
  }
  if (beyond.empty()) return {};
  return {fmt::format(
      "The disturbance's gains are known up to {} Hz; at {} the stage keeps the last of them, so these "
      "figures show phase, lag and clock, not the stage's own rate dependence there.",
      rounded_text(known.back().value), frequency_list(beyond))};
}

Findings few_samples_a_period(const Design& design, const TrackingStudy& study) {
  if (!design.plan) return {};
  const Hertz clock{*design.plan->clocks_hz().begin()};  // the slowest of the plan
  std::vector<Hertz> sampled;
  for (const Hertz f : study.frequency) {
    if (f.value > 0.05 * clock.value) sampled.push_back(f);
  }
  if (sampled.empty()) return {};
  return {fmt::format(
      "The FPAA's slowest clock is {} Hz, fewer than twenty times a period at {}: its compensating waveform is "
      "then a coarse staircase, and aliases above half the clock.",
      rounded_text(clock.value), frequency_list(sampled))};
}

/// Sentences for a person: where a stage is worse than no compensation, where most accuracy is lost, and where a figure
/// says less than it seems to.
std::vector<std::string> tracking_findings(const Project& project, const Design& design, const Budget& budget,
                                           const std::vector<TrackedCandidate>& candidates,
                                           const tracking::Report& report, const TrackingStudy& study) {
  Findings out;
  for (const Findings& some :
       {what_the_drive_changes(study), cascade_worse_than_constant(budget, study),
        what_a_schedule_would_do(study), worse_than_constant(study), worse_than_nothing(study),
        largest_loss(candidates, report, study), beyond_the_known_gains(project, study),
        few_samples_a_period(design, study), what_is_assumed(project)}) {
    out.insert(out.end(), some.begin(), some.end());
  }
  return out;
}

/// Largest difference between CVODE and the harmonic computation. The images of a clocked chain are not in the
/// latter: there the difference is no error of either.
double max_cross_check(const tracking::Report& report) {
  double out = 0.0;
  for (const tracking::Case& one : report.cases) {
    if (one.check) out = std::max(out, one.check->difference_percent);
  }
  return out;
}

/// One period at the highest frequency.
TrackedPeriod shown_period(const tracking::Report& report, const std::vector<TrackedCandidate>& candidates,
                           const std::vector<Hertz>& frequencies, double stroke) {
  TrackedPeriod out;
  out.frequency = *std::ranges::max_element(frequencies);
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
  study.agreement_percent = controllers.agreement_percent;
  study.as_built = as_built_key(project, study);
  study.elsewhere = std::move(elsewhere);
  study.findings = tracking_findings(project, design, budget, candidates, report, study);
  return study;
}

}  // namespace bodesmith::project
