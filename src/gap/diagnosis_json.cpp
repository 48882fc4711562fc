#include "gap/report/files.hpp"

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"

namespace bodesmith::gap {
namespace {

/// JSON has no infinity: of a model that runs away on a record.
Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_of(const GapSize& s) {
  return {{"train_rms", finite_or_null(s.train_rms)},
          {"holdout_rms", finite_or_null(s.holdout_rms)},
          {"holdout_percent_of_range", finite_or_null(s.holdout_percent_of_range)},
          {"train_whole_record_rms", finite_or_null(s.train_whole_rms)},
          {"holdout_whole_record_rms", finite_or_null(s.holdout_whole_rms)}};
}

Json json_of(const std::vector<Cell>& cells) {
  Json all = Json::array();
  for (const auto& c : cells) {
    all.push_back({{"axis", words_of(c.axis).name},
                   {"from", c.from},
                   {"to", c.to},
                   {"share", c.share},
                   {"extent", c.extent}});
    if (c.axis == Axis::input) all.back()["of"] = "input";
    if (c.axis == Axis::output) all.back()["of"] = "output";
  }
  return all;
}

Json json_of(const Ranked& r) {
  Json values = Json::object();
  if (!r.model.terms().empty()) {
    for (const auto& u : r.model.terms().back().unknowns) values[u.name] = u.value;
  }
  return {{"effect", r.effect->told()},
          {"placed", r.placed},
          {"parameters", values},
          {"train_rms_after", r.train_rms},
          {"holdout_rms_after", finite_or_null(r.holdout_rms)},
          {"log_evidence", finite_or_null(r.log_evidence)},
          {"outcome", to_string(r.outcome)}};
}

Json json_of(const std::vector<Ranked>& ranking) {
  Json all = Json::array();
  for (const auto& r : ranking) all.push_back(json_of(r));
  return all;
}

Json runner_up_json(const Step& step) {
  const auto* r = runner_up_of(step);
  if (r == nullptr) return nullptr;
  return {{"effect", r->effect->told()},
          {"holdout_rms_after", finite_or_null(r->holdout_rms)},
          {"outcome", to_string(r->outcome)}};
}

Json json_of(const DiagnosedStep& s, const GapSize& before) {
  Json parameters = Json::object();
  for (const auto& p : s.parameters)
    parameters[p.name] = {{"value", p.value}, {"low", p.low}, {"high", p.high}};
  return {{"effect", s.effect},
          {"tied_with", s.tied_with},
          {"placed", s.placed},
          {"also_placed", s.also_placed},
          {"part", s.part},
          {"parameters", parameters},
          {"holdout_rms_before", finite_or_null(before.holdout_rms)},
          {"holdout_rms_after", finite_or_null(s.after.holdout_rms)},
          {"train_rms_before", finite_or_null(before.train_rms)},
          {"train_rms_after", finite_or_null(s.after.train_rms)},
          {"probability", s.probability}};
}

Json json_of(const AmplitudeDependence& a) {
  Json j = {{"class", to_string(a.kind)},
            {"suspects", suspects_of(a.kind)},
            {"least_drive_v", a.least_drive_v},
            {"largest_drive_v", a.largest_drive_v},
            {"change", a.change},
            {"times_noise", finite_or_null(a.times_noise)}};
  if (a.peak_at_least_hz) j["peak_at_least_hz"] = *a.peak_at_least_hz;
  if (a.peak_at_largest_hz) j["peak_at_largest_hz"] = *a.peak_at_largest_hz;
  return j;
}

Json json_of(const StartChoice& choice) {
  return {{"chosen", to_string(choice.chosen)},
          {"zero_train_rms", finite_or_null(choice.zero_rms)},
          {"equilibrium_train_rms", finite_or_null(choice.equilibrium_rms)},
          {"decided_by", choice.by_search ? "search" : "refit"}};
}

Json json_of(const NoiseFloor& floor) {
  Json j = {{"rms", floor.rms}, {"how", to_string(floor.source)}};
  if (floor.source == NoiseFloor::Source::unknown) j["rms"] = nullptr;
  if (floor.source == NoiseFloor::Source::periods) {
    j["periods"] = floor.periods;
  }
  if (floor.period > 0) {
    j["repeating_odd_rms"] = floor.odd_rms;
    j["repeating_even_rms"] = floor.even_rms;
  }
  return j;
}

}  // namespace

Json to_json(const Diagnosis& d) {
  Json j;
  j["noise_floor"] = json_of(d.floor);
  j["gap"] = {
      {"initial", json_of(d.initial)}, {"refitted", json_of(d.refitted)}, {"final", json_of(d.final)}};
  if (d.relative) {
    j["gap"]["relative"] = std::string("parts of H_model/H_measured - 1, real and imaginary") +
                           (d.weighted ? ", points weighted by their coherence" : "");
  }
  j["scored"] = Json::array();
  for (const auto& s : d.scored_from) {
    j["scored"].push_back({{"file", s.file}, {"held_out", s.held_out}, {"scored_from_s", s.from_s}});
  }
  j["where"] = json_of(d.where);
  j["remaining_where"] = json_of(d.remaining_where);
  j["constant_offsets"] = Json::array();
  for (const auto& o : d.constant_offsets)
    j["constant_offsets"].push_back(
        {{"file", o.file}, {"value", o.value}, {"share", o.share}, {"holdout_rms_without", o.rms_without}});
  j["steps"] = Json::array();
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    Json step = json_of(d.steps[k], d.before(k));
    step["runner_up"] = runner_up_json(d.search.steps[k]);
    step["candidates"] = json_of(d.search.steps[k].ranking);
    step["log_evidence_without"] = finite_or_null(d.search.steps[k].log_evidence_without);
    j["steps"].push_back(std::move(step));
  }
  j["alternatives"] = Json::array();
  for (const auto& set : d.alternatives)
    j["alternatives"].push_back({{"effects", set.effects}, {"probability", set.probability}});
  j["outside"] = d.outside;
  j["log_evidence"] = finite_or_null(d.search.log_evidence);
  j["signs_of_more"] = Json::array();
  for (const auto& s : d.search.structure) {
    j["signs_of_more"].push_back({{"sign", to_string(s.kind)}, {"times_chance", s.strength}});
  }
  if (d.start) j["start"] = json_of(*d.start);
  if (d.amplitude) j["amplitude_dependence"] = json_of(*d.amplitude);
  j["refused"] = json_of(d.search.refused);
  j["verdict"] = to_string(d.verdict);
  j["advice"] = d.advice;
  if (d.next_experiment) {
    j["experiment"] = {{"file", "experiment.csv"},
                       {"separates", d.next_experiment->rivals},
                       {"drive", d.next_experiment->shape},
                       {"difference_over_noise", d.next_experiment->difference_over_noise}};
  }
  j["not_tried"] = d.search.not_tried;
  return j;
}

}  // namespace bodesmith::gap
