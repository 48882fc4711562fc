#include "project/tracking/tracked_designs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/text.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "project/tracking/tracked_plant.hpp"

namespace bodesmith::project {
namespace {

using tracking::ConstantGain;
using tracking::GeneratorForm;
using tracking::Uncompensated;
using Candidates = std::vector<TrackedCandidate>;

constexpr const char* kIdealCascade = "ideal fractional cascade";
constexpr const char* kIntegerSections = "integer sections";
constexpr const char* kFpaaCapacitors = "FPAA, capacitors only";

/// In the time domain the ideal cascade needs integer states: an approximation far closer than anything built here.
tracking::ResponseCompensator ideal_cascade(const Design& design) {
  tracking::ResponseCompensator ideal;
  ideal.response = [&design](RadPerSecond w) { return design.fit->cascade.response(w); };
  ApproximationOptions closer;
  closer.max_error_db = 1e-5;
  const CascadeApproximation reference = approximate_cascade(design.fit->cascade, closer);
  ideal.approximation = reference.sections;
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

/// The rate gains of the branch that is compensated; nothing without a table.
std::optional<tracking::ScheduledGain> rate_table(const Project& project) {
  const Disturbance::RateGains& rate = project.target.disturbance.rate;
  if (rate.frequency.empty()) return std::nullopt;
  return tracking::ScheduledGain{rate.frequency, rate.of(project.target.branch)};
}

/// A triangle's slope is its frequency all the time; anything else needs the mean over some periods.
tracking::SlopeGain slope_gain(const Project& project, const tracking::ScheduledGain& table) {
  tracking::SlopeGain out{table, 1e-4, 0.0};
  const auto slowest = std::min_element(project.track.frequency.begin(), project.track.frequency.end());
  if (project.track.waveform() != tracking::Reference::Shape::triangle)
    out.smoothing_s = 3.0 / slowest->value;
  return out;
}

/// A plan as its switches make it, or its capacitors alone, by its response at the input's own frequency.
tracking::Compensator plan_compensator(const fpaa::Plan& plan, bool hold_and_delays) {
  const auto response = std::make_shared<fpaa::SwitchedBoard>(plan);
  tracking::ResponseCompensator out;
  out.response = [response, hold_and_delays](RadPerSecond w) {
    return hold_and_delays ? response->gain(w) : response->sampled(w);
  };
  return out;
}

/// Collects candidates of one project.
class Collector {
 public:
  Collector(const Project& project, const Design& design) : project_(project), design_(design) {}
  Candidates all();

 private:
  TrackedCandidate& add(std::string_view key, std::string name, tracking::Compensator compensator,
                        GeneratorForm form = GeneratorForm::one_pass(), std::string made_from = {}) {
    TrackedCandidate candidate{std::string(key), false, generator_parts(form),
                               compensated_design(project_, std::move(name), std::move(compensator), form)};
    candidate.design.made_from = std::move(made_from);
    out_.push_back(std::move(candidate));
    return out_.back();
  }
  int generator_parts(GeneratorForm form) const {
    return static_cast<int>(design_.layout->generator_multipliers()) * std::max(1, form.passes);
  }
  void add_comparisons();
  void add_hardware();
  void add_more_passes();
  void add_self_fed_hardware();

  const Project& project_;
  const Design& design_;
  Candidates out_;
};

/// What other ways of compensating would reach in one pass, for comparison.
void Collector::add_comparisons() {
  const Alternative* waveform = best_waveform_fit(design_);
  if (waveform != nullptr && design_.built().kind != Alternative::Kind::waveform)
    add(tracked::waveform, waveform->name, waveform->sections);
  // What no linear filter can do: a gain set by the measured frequency adds no phase.
  if (const auto table = rate_table(project_))
    add(tracked::scheduled, "gain set by the known frequency", *table);
}

void Collector::add_hardware() {
  if (design_.plan) {
    add(tracked::fpaa, kFpaaCapacitors, plan_compensator(*design_.plan, false), GeneratorForm::one_pass(),
        kIntegerSections);
    add(tracked::fpaa_with_holds, "FPAA as its switches make it", plan_compensator(*design_.plan, true),
        GeneratorForm::one_pass(), kFpaaCapacitors)
        .built = true;
  }
  if (design_.paper_plan) {
    const auto cams = design_.paper_plan->cams();
    add(tracked::paper_board,
        fmt::format("the paper's board: {} FilterBilinear on one chip at one clock of {}", cams.size(),
                    engineering_text(cams[0]->clock_a.value, "Hz", 4)),
        plan_compensator(*design_.paper_plan, true));
  }
  if (design_.circuit) {
    TrackedCandidate& circuit =
        add(tracked::circuit, project_.circuit->resistors + " circuit",
            design_.realised().circuit.realised_sections(), GeneratorForm::one_pass(), kIntegerSections);
    circuit.built = true;
    circuit.parts += static_cast<int>(design_.realised().circuit.stages.size());
  }
}

void Collector::add_more_passes() {
  const auto table = rate_table(project_);
  add(tracked::two_passes, "two passes", ConstantGain{}, GeneratorForm::two_passes());
  if (table)
    add(tracked::two_passes_scheduled, "two passes, gain by the known frequency", *table,
        GeneratorForm::two_passes());
  const GeneratorForm loop = GeneratorForm::self_fed();
  add(tracked::self_fed, "self-fed", ConstantGain{}, loop).built = true;
  add(tracked::self_fed_sections, "self-fed, integer sections", design_.sections(), loop);
  if (!table) return;
  add(tracked::self_fed_scheduled, "self-fed, gain by the known frequency", *table, loop);
  add(tracked::self_fed_slope, "self-fed, gain by the measured slope", slope_gain(project_, *table), loop);
  const tracking::FilterAndSchedule sum{
      design_.sections(),
      tracking::rest_of(design_.sections(), project_.target.disturbance, project_.target.branch)};
  add(tracked::self_fed_sum, "self-fed, sections and gain by the known frequency", sum, loop);
}

void Collector::add_self_fed_hardware() {
  const GeneratorForm loop = GeneratorForm::self_fed();
  if (design_.plan) {
    add(tracked::self_fed_fpaa, "self-fed, FPAA with holds", plan_compensator(*design_.plan, true), loop);
  }
  if (design_.circuit) {
    TrackedCandidate& circuit =
        add(tracked::self_fed_circuit, "self-fed, " + project_.circuit->resistors + " circuit",
            design_.realised().circuit.realised_sections(), loop);
    circuit.built = true;
    circuit.parts += static_cast<int>(design_.realised().circuit.stages.size());
  }
}

Candidates Collector::all() {
  out_.push_back({std::string(tracked::none),
                  false,
                  0,
                  {"without compensation", Uncompensated{}, Uncompensated{}, "", GeneratorForm::one_pass()}});
  add(tracked::polynomial, "constant polynomial", ConstantGain{}).built = true;
  add(tracked::cascade, kIdealCascade, ideal_cascade(design_));
  const bool from_cascade = design_.built().kind == Alternative::Kind::cascade;
  add(tracked::sections, kIntegerSections, design_.sections(), GeneratorForm::one_pass(),
      from_cascade ? kIdealCascade : "");
  add_comparisons();
  add_hardware();
  add_more_passes();
  add_self_fed_hardware();
  return std::move(out_);
}

}  // namespace

std::vector<TrackedCandidate> tracked_candidates(const Project& project, const Design& design) {
  return Collector(project, design).all();
}

TrackedDesign tracked_design(const TrackedCandidate& candidate, const std::vector<Hertz>& frequencies,
                             const tracking::Report& report) {
  TrackedDesign out{candidate.key, candidate.design.name, candidate.built, candidate.parts, {}, {}};
  for (const Hertz f : frequencies) {
    const tracking::Case& found = *report.find(f, out.name);
    out.at.push_back(found);
    if (found.on_reference_percent) out.on_reference_percent.push_back(*found.on_reference_percent);
  }
  return out;
}

}  // namespace bodesmith::project
