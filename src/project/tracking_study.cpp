#include "project/tracking_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "tracking/tracking.hpp"

namespace bodesmith::project {
namespace {

using tracking::ClockedCompensator;
using tracking::Compensator;
using tracking::ConstantGain;
using tracking::ResponseCompensator;
using tracking::TrackingDesign;
using tracking::Uncompensated;

/// The plan's CAMs as one sampled chain.
ClockedCompensator clocked(const fpaa::Plan& plan, bool hold_and_delays) {
  ClockedCompensator out;
  for (const fpaa::PlacedCam* cam : plan.cams()) {
    out.sections.push_back({cam->z.numerator, cam->z.denominator});
    out.delay_cycles += cam->delay_cycles;
    out.clock = cam->clock_a;
  }
  out.hold_and_delays = hold_and_delays;
  return out;
}

struct Choice {
  std::string key;
  TrackingDesign design;
};

/// The compensator stands in the path of the branch that changes with frequency; the other keeps its
/// polynomial.
Choice compensated(const Project& project, std::string key, std::string name, Compensator compensator,
                   std::string made_from) {
  TrackingDesign design{std::move(name), ConstantGain{}, ConstantGain{}, std::move(made_from)};
  (project.target.branch == Disturbance::Branch::ascending ? design.ascending : design.descending) =
      std::move(compensator);
  return {std::move(key), std::move(design)};
}

std::vector<Choice> choices(const Project& project, const Design& design) {
  std::vector<Choice> out;
  out.push_back({"none", {"without compensation", Uncompensated{}, Uncompensated{}, ""}});
  out.push_back({"polynomial", {"constant polynomial", ConstantGain{}, ConstantGain{}, ""}});
  const Sections& sections = design.sections();
  ResponseCompensator ideal;
  ideal.response = [&design](RadPerSecond w) { return design.fit.cascade.response(w); };
  // In the time domain the ideal cascade needs integer states: an approximation far closer than anything
  // built here.
  ApproximationOptions closer;
  closer.max_error_db = 1e-5;
  const CascadeApproximation reference = approximate_cascade(design.fit.cascade, closer);
  ideal.approximation = reference.sections;
  ideal.approximation_error_db = reference.error.everywhere_db;
  out.push_back(compensated(project, "cascade", "ideal fractional cascade", ideal, ""));
  const bool from_cascade = design.alternatives[design.chosen].kind == Alternative::Kind::cascade;
  out.push_back(compensated(project, "sections", "integer sections", sections,
                            from_cascade ? "ideal fractional cascade" : ""));
  // What a fit to the waveform itself would reach, when something else is built.
  const Alternative* waveform = nullptr;
  for (const Alternative& a : design.alternatives) {
    if (a.kind != Alternative::Kind::waveform) continue;
    if (waveform == nullptr || a.waveform.worst_percent < waveform->waveform.worst_percent) waveform = &a;
  }
  if (waveform != nullptr && design.alternatives[design.chosen].kind != Alternative::Kind::waveform) {
    out.push_back(compensated(project, "waveform", waveform->name, waveform->sections, ""));
  }
  // What no linear filter can do: a gain set by the measured frequency turns no phase.
  const Disturbance::RateGains& rate = project.target.disturbance.rate;
  if (!rate.frequency.empty()) {
    const bool ascending = project.target.branch == Disturbance::Branch::ascending;
    const tracking::ScheduledGain scheduled{rate.frequency, ascending ? rate.ascending : rate.descending};
    out.push_back(compensated(project, "scheduled", "gain set by the measured frequency", scheduled, ""));
  }
  if (design.plan) {
    out.push_back(compensated(project, "fpaa", "FPAA, capacitors only", clocked(*design.plan, false),
                              "integer sections"));
    out.push_back(compensated(project, "fpaa_with_holds", "FPAA with sample, hold and delay",
                              clocked(*design.plan, true), "FPAA, capacitors only"));
  }
  if (design.circuit) {
    out.push_back(compensated(project, "circuit", project.circuit->resistors + " circuit",
                              design.circuit->circuit.realised_sections(), "integer sections"));
  }
  return out;
}

tracking::TrackingPlant plant_of(const Project& project) {
  tracking::TrackingPlant plant;
  plant.disturbance = project.target.disturbance;
  plant.stroke = project.plant.stroke_m;
  if (project.plant.amplifier_corner)
    plant.drive_path = tracking::lowpass_path(*project.plant.amplifier_corner);
  std::vector<Sections> stage;
  if (project.plant.damping_compensator) {
    Sections damping;
    damping.sections = {*project.plant.damping_compensator};
    stage.push_back(damping);
  }
  if (project.plant.resonance)
    stage.push_back(tracking::resonance_path(*project.plant.resonance, project.plant.damping_ratio));
  if (!stage.empty()) plant.stage_path = tracking::in_series(stage);
  return plant;
}

void keep_period(const tracking::TrackingReport& report, const std::vector<Choice>& all, double stroke,
                 TrackingStudy& study) {
  study.shown.frequency = *std::max_element(study.frequency.begin(), study.frequency.end());
  for (const Choice& choice : all) {
    const tracking::TrackingCase* found = report.find(study.shown.frequency, choice.design.name);
    if (study.shown.time_s.empty()) {
      study.shown.time_s = found->time_s;
      for (const double r : found->reference) study.shown.reference.push_back(r / stroke);
    }
    std::vector<double> error;
    for (size_t i = 0; i < found->displacement.size(); ++i) {
      error.push_back(100.0 * (found->displacement[i] - found->reference[i]) / stroke);
    }
    study.shown.error_percent.push_back(std::move(error));
  }
}

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

/// The surprise of the first seed's method: the magnitude is met, and the waveform gets worse. Pure delay is
/// no matter of the compensator: figures without it.
void find_worse_than_constant(const Budget& budget, TrackingStudy& study) {
  const TrackedDesign* constant = study.find("polynomial");
  const TrackedDesign* cascade = study.find("cascade");
  std::vector<Hertz> worse;
  size_t most = 0;
  const auto excess = [&](size_t i) {
    return cascade->rms_percent_without_lag[i] - constant->rms_percent_without_lag[i];
  };
  for (size_t i = 0; i < study.frequency.size(); ++i) {
    if (cascade->rms_percent_without_lag[i] > 1.02 * constant->rms_percent_without_lag[i])
      worse.push_back(study.frequency[i]);
    if (excess(i) > excess(most)) most = i;
  }
  if (worse.empty()) return;
  study.findings.push_back(fmt::format(
      "Magnitude-only compensation is worse than the constant polynomial at {} ({} % of range rms instead of "
      "{} % at {} Hz, pure delay removed): "
      "it meets the gain at the fundamental, but turns the phase of a waveform that has harmonics. Fit the "
      "waveform instead: "
      "bodesmith fit --waveform.",
      frequency_list(worse), rounded_text(cascade->rms_percent_without_lag[most], 3),
      rounded_text(constant->rms_percent_without_lag[most], 3), rounded_text(study.frequency[most].value)));
  if (budget.magnitude_only_is_worse) {
    study.findings.push_back(fmt::format(
        "Over all tracked frequencies the cascade's compensating waveform is off by {} % of range at worst, "
        "{} % without any "
        "rate compensation, {} % with the best fixed gain.",
        rounded_text(budget.rows.front().waveform.worst_percent, 3),
        rounded_text(budget.uncompensated.worst_percent, 3), rounded_text(budget.constant.worst_percent, 3)));
  }
}

double worst_of(const TrackedDesign& design) {
  return *std::max_element(design.rms_percent_without_lag.begin(), design.rms_percent_without_lag.end());
}

/// A filter turns phase whatever its order; a gain driven by the frequency does not.
void find_what_a_schedule_would_do(TrackingStudy& study) {
  const TrackedDesign* scheduled = study.find("scheduled");
  const TrackedDesign* waveform = study.find("waveform");
  if (waveform == nullptr) waveform = study.find("sections");
  if (scheduled == nullptr || waveform == nullptr) return;
  const double with = worst_of(*scheduled);
  const double without = worst_of(*waveform);
  if (with > 0.5 * without) return;
  study.findings.push_back(
      fmt::format("No linear filter does what a gain set by the measured frequency does: {} % of range rms "
                  "at worst (pure delay removed), against {} % with '{}'.",
                  rounded_text(with, 3), rounded_text(without, 3), waveform->name));
}

/// At which step most of the accuracy goes: rms change of the compensating waveform from one design to the
/// next.
void find_largest_loss(const std::vector<Choice>& all, const tracking::TrackingReport& report,
                       TrackingStudy& study) {
  const tracking::TrackingCase* largest = nullptr;
  const Choice* step = nullptr;
  for (const Choice& choice : all) {
    if (choice.design.made_from.empty()) continue;
    for (const Hertz f : study.frequency) {
      const tracking::TrackingCase* found = report.find(f, choice.design.name);
      if (largest == nullptr || found->lost_rms_percent > largest->lost_rms_percent) {
        largest = found;
        step = &choice;
      }
    }
  }
  if (largest == nullptr) return;
  study.findings.push_back(
      fmt::format("Most accuracy is lost from '{}' to '{}': the compensating waveform changes by {} % of "
                  "range rms at {} Hz.",
                  step->design.made_from, step->design.name, rounded_text(largest->lost_rms_percent, 3),
                  rounded_text(largest->frequency.value)));
}

/// Where a figure says less than it seems to.
void find_beyond_what_is_known(const Project& project, const Design& design, TrackingStudy& study) {
  const std::vector<Hertz>& known = project.target.disturbance.rate.frequency;
  std::vector<Hertz> beyond;
  for (const Hertz f : study.frequency) {
    if (!known.empty() && f.value > 1.001 * known.back().value) beyond.push_back(f);
  }
  if (!beyond.empty()) {
    study.findings.push_back(fmt::format(
        "The disturbance's gains are known up to {} Hz; at {} the stage keeps the last of them, so these "
        "figures tell of phase, lag and clock, not of the stage's own rate dependence there.",
        rounded_text(known.back().value), frequency_list(beyond)));
  }
  if (!design.plan) return;
  const Hertz clock = clocked(*design.plan, true).clock;
  std::vector<Hertz> sampled;
  for (const Hertz f : study.frequency) {
    if (f.value > 0.05 * clock.value) sampled.push_back(f);
  }
  if (sampled.empty()) return;
  study.findings.push_back(
      fmt::format("The FPAA samples at {} Hz, fewer than twenty times a period at {}: its compensating "
                  "waveform is then stairs, and noise above half the clock.",
                  rounded_text(clock.value), frequency_list(sampled)));
}

}  // namespace

TrackingStudy study_tracking(const Project& project, const Design& design, const Budget& budget) {
  const std::vector<Choice> all = choices(project, design);
  std::vector<TrackingDesign> designs;
  for (const Choice& choice : all) designs.push_back(choice.design);
  tracking::TrackingOptions options;
  options.frequencies = project.track.frequency;
  // A compensator stands in the path of its own branch; the switch picks behind it (first seed, Fig. 2).
  options.place = tracking::TrackingOptions::Place::before_switch;
  options.reference = project.track.sine ? tracking::TrackingOptions::Reference::sine
                                         : tracking::TrackingOptions::Reference::triangle;
  const tracking::TrackingPlant plant = plant_of(project);
  const tracking::TrackingReport report = tracking::track(plant, designs, options);

  TrackingStudy study;
  study.frequency = project.track.frequency;
  study.compute_s = report.compute_s;
  for (const Choice& choice : all) {
    TrackedDesign tracked{choice.key, choice.design.name, {}, {}, {}, {}};
    for (const Hertz f : study.frequency) {
      const tracking::TrackingCase* found = report.find(f, choice.design.name);
      tracked.rms_percent.push_back(found->rms_percent);
      tracked.max_percent.push_back(found->max_percent);
      tracked.rms_percent_without_lag.push_back(found->rms_percent_without_lag);
      tracked.lag_s.push_back(found->lag_s);
      // A clocked chain's images are not in the harmonic computation: there the difference is no error of
      // either.
      if (found->method == "cvode" && !found->check_method.empty()) {
        study.largest_cross_check_percent =
            std::max(study.largest_cross_check_percent, found->check_difference_percent);
      }
    }
    study.designs.push_back(std::move(tracked));
  }
  keep_period(report, all, plant.stroke, study);
  find_worse_than_constant(budget, study);
  find_what_a_schedule_would_do(study);
  find_largest_loss(all, report, study);
  find_beyond_what_is_known(project, design, study);
  return study;
}

}  // namespace bodesmith::project
