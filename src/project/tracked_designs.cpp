#include "project/tracked_designs.hpp"

#include "tracking/paths.hpp"

namespace bodesmith::project {
namespace {

using tracking::ConstantGain;
using tracking::Uncompensated;

constexpr const char* kIdealCascade = "ideal fractional cascade";
constexpr const char* kIntegerSections = "integer sections";
constexpr const char* kFpaaCapacitors = "FPAA, capacitors only";

/// The compensator stands in the path of the branch that changes with frequency; the other one keeps its
/// polynomial.
TrackedCandidate compensated(const Project& project, TrackedStage stage, std::string name,
                             tracking::Compensator compensator, std::string made_from) {
  tracking::Design design{std::move(name), ConstantGain{}, ConstantGain{}, std::move(made_from)};
  (project.target.branch == Disturbance::Branch::ascending ? design.ascending : design.descending) =
      std::move(compensator);
  return {stage, std::move(design)};
}

/// In the time domain the ideal cascade needs integer states: an approximation far closer than anything built here.
tracking::ResponseCompensator ideal_cascade(const Design& design) {
  tracking::ResponseCompensator ideal;
  ideal.response = [&design](RadPerSecond w) { return design.fit.cascade.response(w); };
  ApproximationOptions closer;
  closer.max_error_db = 1e-5;
  const CascadeApproximation reference = approximate_cascade(design.fit.cascade, closer);
  ideal.approximation = reference.sections;
  ideal.approximation_error_db = reference.error.everywhere_db;
  return ideal;
}

/// The waveform fit of smallest worst-case error; null when there is none.
const Alternative* best_waveform_fit(const Design& design) {
  const Alternative* best = nullptr;
  for (const Alternative& a : design.alternatives) {
    if (a.kind != Alternative::Kind::waveform) continue;
    if (best == nullptr || a.waveform.worst_percent < best->waveform.worst_percent) best = &a;
  }
  return best;
}

/// What other ways of compensating would reach, for comparison.
void add_comparisons(const Project& project, const Design& design, std::vector<TrackedCandidate>& out) {
  const Alternative* waveform = best_waveform_fit(design);
  if (waveform != nullptr && design.built().kind != Alternative::Kind::waveform) {
    out.push_back(compensated(project, TrackedStage::waveform, waveform->name, waveform->sections, ""));
  }
  // What no linear filter can do: a gain set by the measured frequency adds no phase.
  const Disturbance::RateGains& rate = project.target.disturbance.rate;
  if (!rate.frequency.empty()) {
    const bool ascending = project.target.branch == Disturbance::Branch::ascending;
    const tracking::ScheduledGain scheduled{rate.frequency, ascending ? rate.ascending : rate.descending};
    out.push_back(
        compensated(project, TrackedStage::scheduled, "gain set by the measured frequency", scheduled, ""));
  }
}

void add_hardware(const Project& project, const Design& design, std::vector<TrackedCandidate>& out) {
  if (design.plan) {
    out.push_back(compensated(project, TrackedStage::fpaa, kFpaaCapacitors,
                              clocked_compensator(*design.plan, false), kIntegerSections));
    out.push_back(compensated(project, TrackedStage::fpaa_with_holds, "FPAA with sample, hold and delay",
                              clocked_compensator(*design.plan, true), kFpaaCapacitors));
  }
  if (design.circuit) {
    out.push_back(compensated(project, TrackedStage::circuit, project.circuit->resistors + " circuit",
                              design.circuit->circuit.realised_sections(), kIntegerSections));
  }
}

}  // namespace

tracking::ClockedCompensator clocked_compensator(const fpaa::Plan& plan, bool hold_and_delays) {
  tracking::ClockedCompensator out;
  for (const fpaa::PlacedCam* cam : plan.cams()) {
    out.sections.push_back({cam->z.numerator, cam->z.denominator});
    out.delay_cycles += cam->delay_cycles;
    out.clock = cam->clock_a;
  }
  out.hold_and_delays = hold_and_delays;
  return out;
}

std::vector<TrackedCandidate> tracked_candidates(const Project& project, const Design& design) {
  std::vector<TrackedCandidate> out;
  out.push_back({TrackedStage::none, {"without compensation", Uncompensated{}, Uncompensated{}, ""}});
  out.push_back({TrackedStage::polynomial, {"constant polynomial", ConstantGain{}, ConstantGain{}, ""}});
  out.push_back(compensated(project, TrackedStage::cascade, kIdealCascade, ideal_cascade(design), ""));
  const bool from_cascade = design.built().kind == Alternative::Kind::cascade;
  out.push_back(compensated(project, TrackedStage::sections, kIntegerSections, design.sections(),
                            from_cascade ? kIdealCascade : ""));
  add_comparisons(project, design, out);
  add_hardware(project, design, out);
  return out;
}

tracking::Plant tracking_plant(const Project& project) {
  tracking::Plant plant;
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

}  // namespace bodesmith::project
