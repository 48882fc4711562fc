#include "project/tracking/tracked_designs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "tracking/track.hpp"

namespace bodesmith::project {
namespace {

using tracking::ConstantGain;
using tracking::GeneratorForm;
using tracking::Uncompensated;

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
  const auto slowest = std::ranges::min_element(project.track.frequency);
  if (project.track.waveform() != tracking::Reference::Shape::triangle)
    out.smoothing_s = 3.0 / slowest->value;
  return out;
}

/// A plan as its switches make it, or its capacitors alone, by its response at the input's own frequency.
tracking::Compensator plan_compensator(const fpaa::Plan& plan, bool hold_and_delays) {
  const auto response = std::make_shared<fpaa::SwitchedBoard>(plan);
  tracking::ResponseCompensator out;
  out.response = remembered([response, hold_and_delays](RadPerSecond w) {
    return hold_and_delays ? response->gain(w) : response->sampled(w);
  });
  return out;
}

}  // namespace

std::vector<TrackedCandidate> tracked_candidates(const Project& project, const Design& design) {
  constexpr GeneratorForm once = GeneratorForm::one_pass(), twice = GeneratorForm::two_passes(),
                          loop = GeneratorForm::self_fed();
  std::vector<TrackedCandidate> out;
  const auto add = [&](std::string_view key, std::string name, tracking::Compensator compensator,
                       GeneratorForm form, std::string made_from = {}) -> TrackedCandidate& {
    const int multipliers = static_cast<int>(design.layout->generator_multipliers());
    TrackedCandidate& one = out.emplace_back(
        TrackedCandidate{std::string(key), false, multipliers * std::max(1, form.passes),
                         compensated_design(project, std::move(name), std::move(compensator), form)});
    one.design.made_from = std::move(made_from);
    return one;
  };
  const auto add_circuit = [&](std::string_view key, const char* before, GeneratorForm form,
                               std::string made_from) {
    if (!design.circuit) return;
    const synthesis::Circuit& circuit = design.realised().circuit;
    TrackedCandidate& one = add(key, before + project.circuit->resistors + " circuit",
                                circuit.realised_sections(), form, std::move(made_from));
    one.built = true;
    one.parts += static_cast<int>(circuit.stages.size());
  };
  const Sections& sections = design.sections();
  const auto table = rate_table(project);

  out.push_back({std::string(tracked::none),
                 false,
                 0,
                 {"without compensation", Uncompensated{}, Uncompensated{}, "", once}});
  add(tracked::polynomial, "constant polynomial", ConstantGain{}, once).built = true;
  add(tracked::cascade, kIdealCascade, ideal_cascade(design), once);
  add(tracked::sections, kIntegerSections, sections, once,
      design.built().kind == Alternative::Kind::cascade ? kIdealCascade : "");
  if (const Alternative* waveform = best_waveform_fit(design);
      waveform != nullptr && design.built().kind != Alternative::Kind::waveform)
    add(tracked::waveform, waveform->name, waveform->sections, once);
  // What no linear filter can do: a gain set by the measured frequency adds no phase.
  if (table) add(tracked::scheduled, "gain set by the known frequency", *table, once);
  tracking::Compensator switched;
  if (design.plan) {
    switched = plan_compensator(*design.plan, true);
    add(tracked::fpaa, kFpaaCapacitors, plan_compensator(*design.plan, false), once, kIntegerSections);
    add(tracked::fpaa_with_holds, "FPAA as its switches make it", switched, once, kFpaaCapacitors).built =
        true;
  }
  if (design.paper_plan) {
    const auto cams = design.paper_plan->cams();
    add(tracked::paper_board,
        fmt::format("the paper's board: {} FilterBilinear on one chip at one clock of {}", cams.size(),
                    engineering_text(cams[0]->clock_a.value, "Hz", 4)),
        plan_compensator(*design.paper_plan, true), once);
  }
  add_circuit(tracked::circuit, "", once, kIntegerSections);

  add(tracked::two_passes, "two passes", ConstantGain{}, twice);
  if (table) add(tracked::two_passes_scheduled, "two passes, gain by the known frequency", *table, twice);

  add(tracked::self_fed, "self-fed", ConstantGain{}, loop).built = true;
  add(tracked::self_fed_sections, "self-fed, integer sections", sections, loop);
  if (table) {
    add(tracked::self_fed_scheduled, "self-fed, gain by the known frequency", *table, loop);
    add(tracked::self_fed_slope, "self-fed, gain by the measured slope", slope_gain(project, *table), loop);
    add(tracked::self_fed_sum, "self-fed, sections and gain by the known frequency",
        tracking::FilterAndSchedule{
            sections, tracking::rest_of(sections, project.target.disturbance, project.target.branch)},
        loop);
  }
  if (design.plan) add(tracked::self_fed_fpaa, "self-fed, FPAA with holds", switched, loop);
  add_circuit(tracked::self_fed_circuit, "self-fed, ", loop, {});
  return out;
}

std::vector<std::string> take_out_unsettled(const tracking::Plant& plant, tracking::Options options,
                                            std::vector<TrackedCandidate>& candidates) {
  options.time_domain = false;
  std::vector<std::string> out;
  std::erase_if(candidates, [&](const TrackedCandidate& one) {
    if (!one.design.form.is_self_fed()) return false;
    try {
      tracking::track(plant, {one.design}, options);
      return false;
    } catch (const DesignError& error) {
      out.push_back(fmt::format("Not tracked: {}.", error.what()));
      return true;
    }
  });
  return out;
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
