#include "project/tracking_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "simulate/tracking.hpp"

namespace bodesmith::project {
namespace {

using simulate::ClockedCompensator;
using simulate::Compensator;
using simulate::ConstantGain;
using simulate::ResponseCompensator;
using simulate::TrackingDesign;
using simulate::Uncompensated;

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
  const Sections& sections = design.approximation.sections;
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
  out.push_back(compensated(project, "sections", "integer sections", sections, "ideal fractional cascade"));
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

simulate::TrackingPlant plant_of(const Project& project) {
  simulate::TrackingPlant plant;
  plant.disturbance = project.target.disturbance;
  plant.stroke = project.plant.stroke_m;
  if (project.plant.amplifier_corner)
    plant.drive_path = simulate::lowpass_path(*project.plant.amplifier_corner);
  std::vector<Sections> stage;
  if (project.plant.damping_compensator) {
    Sections damping;
    damping.sections = {*project.plant.damping_compensator};
    stage.push_back(damping);
  }
  if (project.plant.resonance)
    stage.push_back(simulate::resonance_path(*project.plant.resonance, project.plant.damping_ratio));
  if (!stage.empty()) plant.stage_path = simulate::in_series(stage);
  return plant;
}

void keep_period(const simulate::TrackingReport& report, const std::vector<Choice>& all, double stroke,
                 TrackingStudy& study) {
  study.shown.frequency = *std::max_element(study.frequency.begin(), study.frequency.end());
  for (const Choice& choice : all) {
    const simulate::TrackingCase* found = report.find(study.shown.frequency, choice.design.name);
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

}  // namespace

TrackingStudy study_tracking(const Project& project, const Design& design, const Budget& budget) {
  const std::vector<Choice> all = choices(project, design);
  std::vector<TrackingDesign> designs;
  for (const Choice& choice : all) designs.push_back(choice.design);
  simulate::TrackingOptions options;
  options.frequencies = project.track.frequency;
  options.reference = project.track.sine ? simulate::TrackingOptions::Reference::sine
                                         : simulate::TrackingOptions::Reference::triangle;
  const simulate::TrackingPlant plant = plant_of(project);
  const simulate::TrackingReport report = simulate::track(plant, designs, options);

  TrackingStudy study;
  study.frequency = project.track.frequency;
  study.compute_s = report.compute_s;
  study.findings = report.findings;
  for (const Choice& choice : all) {
    TrackedDesign tracked{choice.key, choice.design.name, {}, {}};
    for (const Hertz f : study.frequency) {
      const simulate::TrackingCase* found = report.find(f, choice.design.name);
      tracked.rms_percent.push_back(found->rms_percent);
      tracked.max_percent.push_back(found->max_percent);
      if (!found->check_method.empty()) {
        study.largest_cross_check_percent =
            std::max(study.largest_cross_check_percent, found->check_difference_percent);
      }
    }
    study.designs.push_back(std::move(tracked));
  }
  keep_period(report, all, plant.stroke, study);
  if (budget.magnitude_only_is_worse) {
    const std::string sentence = fmt::format(
        "Magnitude-only compensation is worse than none of the rate effect: the cascade's waveform is off by "
        "{} % of range "
        "at its worst frequency, {} % without any rate compensation, because it turns the phase of the "
        "waveform and its "
        "harmonics.",
        rounded_text(budget.rows.front().waveform.worst_percent, 3),
        rounded_text(budget.uncompensated.worst_percent, 3));
    study.findings.insert(study.findings.begin(), sentence);
  }
  return study;
}

}  // namespace bodesmith::project
