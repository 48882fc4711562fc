#include "gap/diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/json.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::gap {
namespace {

/// Residuals of one record from its first to its last sample, as `simulate` makes them.
std::vector<double> whole_residual(const Model& model, const Experiment& experiment) {
  if (const auto* time = dynamic_cast<const TimeExperiment*>(&experiment)) {
    simulate::Options options;
    options.estimate_error = false;
    const auto result = simulate::simulate(model.chain(), time->record(), options);
    std::vector<double> e(time->to());
    for (std::size_t i = 0; i < e.size(); ++i) e[i] = time->record().y[i] - result.y[i];
    return e;
  }
  auto e = residuals_of(model, {&experiment});
  for (double& x : e) x = -x;
  return e;
}

/// Where scoring starts in each record: at its first sample, unless the start stands out even under the final
/// model.
std::vector<std::size_t> scoring_starts(const Model& final, const Experiments& experiments, bool split) {
  std::vector<std::size_t> starts;
  for (const auto* e : experiments) {
    const auto* time = dynamic_cast<const TimeExperiment*>(e);
    if (time == nullptr || time->skip() == 0) {
      starts.push_back(0);
      continue;
    }
    const auto residual = whole_residual(final, *e);
    const auto cut = residual.begin() + static_cast<std::ptrdiff_t>(time->skip());
    const bool stands_out = rms({residual.begin(), cut}) > 1.5 * rms({cut, residual.end()});
    starts.push_back(split || stands_out ? time->skip() : 0);
  }
  return starts;
}

class Scorer {
 public:
  Scorer(const Study& study, const Model& final)
      : study_(study),
        train_from_(scoring_starts(final, study.train(), false)),
        holdout_from_(scoring_starts(final, study.holdout(), study.split())) {}

  GapSize size(const Model& model) const {
    GapSize s;
    double range = 0.0;
    for (const auto* e : study_.holdout()) range = std::max(range, e->range());
    std::tie(s.train_rms, s.train_whole_rms) = pooled(model, study_.train(), train_from_);
    std::tie(s.holdout_rms, s.holdout_whole_rms) = pooled(model, study_.holdout(), holdout_from_);
    s.holdout_percent_of_range = 100.0 * s.holdout_rms / range;
    return s;
  }
  std::vector<ScoredFrom> scored_from() const {
    std::vector<ScoredFrom> all;
    const auto add = [&](const Experiments& experiments, const std::vector<std::size_t>& from,
                         bool held_out) {
      for (std::size_t i = 0; i < experiments.size(); ++i) {
        const auto* time = dynamic_cast<const TimeExperiment*>(experiments[i]);
        if (time != nullptr) all.push_back({time->file(), held_out, time->record().time_s(from[i])});
      }
    };
    add(study_.train(), train_from_, false);
    add(study_.holdout(), holdout_from_, true);
    return all;
  }
  const std::vector<std::size_t>& holdout_from() const { return holdout_from_; }

 private:
  static std::pair<double, double> pooled(const Model& model, const Experiments& experiments,
                                          const std::vector<std::size_t>& from) {
    std::vector<double> scored;
    std::vector<double> whole;
    for (std::size_t i = 0; i < experiments.size(); ++i) {
      const auto e = whole_residual(model, *experiments[i]);
      scored.insert(scored.end(), e.begin() + static_cast<std::ptrdiff_t>(from[i]), e.end());
      whole.insert(whole.end(), e.begin(), e.end());
    }
    return {rms(scored), rms(whole)};
  }
  const Study& study_;
  std::vector<std::size_t> train_from_;
  std::vector<std::size_t> holdout_from_;
};

/// Where the gap of the held-out record with the largest gap lies.
std::vector<Cell> where_is(const Model& model, const Study& study, const std::vector<std::size_t>& from) {
  double most = -1.0;
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < study.holdout().size(); ++i) {
    const auto* e = study.holdout()[i];
    const auto residual = whole_residual(model, *e);
    const double size = rms(residual);
    if (size <= most) continue;
    most = size;
    if (const auto* time = dynamic_cast<const TimeExperiment*>(e)) {
      const std::vector<double> later(time->record().u.begin() + static_cast<std::ptrdiff_t>(from[i]),
                                      time->record().u.end());
      cells = where(time->record(), residual, from[i], find_period(later));
    } else if (const auto* response = dynamic_cast<const FrequencyExperiment*>(e)) {
      cells = where(response->record(), residual);
    }
  }
  return cells;
}

std::string cell_text(const Cell& c) {
  if (c.axis == "branch") {
    const char* word = c.from == c.to ? (c.to > 0 ? "rising" : c.to < 0 ? "falling" : "resting") : "changing";
    return fmt::format("while the input is {} ({:.0f} % of it)", word, 100.0 * c.share);
  }
  const char* unit = c.axis == "frequency_hz" ? " Hz" : c.axis == "time_s" ? " s" : "";
  return fmt::format("{} {} to {}{} ({:.0f} % of it)",
                     c.axis == "frequency_hz" ? "frequencies"
                     : c.axis == "time_s"     ? "times"
                     : c.axis == "amplitude"  ? "inputs from"
                                              : "harmonics",
                     rounded_text(c.from, 3), rounded_text(c.to, 3), unit, 100.0 * c.share);
}

std::string advice_for(const Diagnosis& d, const Study& study) {
  std::vector<std::string> advice;
  for (const auto& s : d.steps) {
    if (s.tied_with.empty()) continue;
    std::string text = fmt::format("These records cannot tell {} from {}; what would: {}", s.effect,
                                   join(s.tied_with, ", "), find_effect(s.effect)->experiment());
    for (const auto& t : s.tied_with) {
      const std::string other(find_effect(t)->experiment());
      if (text.find(other) == std::string::npos) text += "; " + other;
    }
    advice.push_back(text + ".");
  }
  if (d.verdict == Verdict::unexplained || d.verdict == Verdict::partly_explained) {
    std::string text = d.steps.empty() ? "Something is missing that no effect of the catalogue explains"
                                       : "Something else is missing that no effect of the catalogue explains";
    if (!d.remaining_where.empty()) text += "; look at " + cell_text(d.remaining_where.front());
    advice.push_back(text + ".");
  }
  if (d.floor.how == NoiseFloor::How::unknown && !study.frequency_responses()) {
    advice.push_back(
        "The noise floor is unknown: record at least two periods of a repeating input to know it.");
  }
  if (study.split()) {
    advice.push_back(
        "Nothing was held out, so a part of the same records was: a record with another excitation would "
        "prove more.");
  }
  if (d.search.stopped) advice.push_back("The search was stopped before its end: this is the best so far.");
  for (const auto& n : d.search.notes) advice.push_back(n + ".");
  return join(advice, " ");
}

DiagnosedStep step_of(const Step& step, const Scorer& scorer) {
  DiagnosedStep s;
  s.effect = step.effect->name();
  s.tied_with = step.tied_with;
  s.also_fit = step.also_fit;
  s.placed = step.placed;
  s.also_placed = step.also_placed;
  s.before = scorer.size(step.before);
  s.after = scorer.size(step.after);
  s.control_gain = step.control_gain;
  const Ranked* rival = nullptr;
  for (const auto& r : step.ranking) {
    if (r.effect == step.effect) {
      if (r.word == "named") s.significance = r.z;
      continue;
    }
    if (rival == nullptr || r.holdout_rms < rival->holdout_rms) rival = &r;
  }
  if (rival != nullptr && !rival->model.terms().empty()) {
    s.runner_up = rival->effect->name();
    s.runner_up_word = rival->word;
    s.runner_up_holdout_rms = scorer.size(rival->model).holdout_rms;
  }
  return s;
}

/// Values of the terms in the final model, with twice their standard deviation, the residual's colour
/// counted.
void add_parameters(Diagnosis& d, const Experiments& train) {
  const auto& model = d.search.final;
  Runner runner(model, train);
  const auto unknowns = model.unknowns();
  LeastSquaresOptions options;
  options.iterations = 1;
  const auto result = least_squares(
      unknowns, [&](std::span<const double> v, std::vector<double>& out) { return runner(v, out); }, options);
  const double inflation = result.usable ? std::sqrt(correlation_time(result.residuals)) : 1.0;
  std::size_t at = model.free_count();
  for (std::size_t k = 0; k < model.terms().size() && k < d.steps.size(); ++k) {
    for (const auto& u : model.terms()[k].unknowns) {
      const double sigma =
          result.usable && at < result.deviation.size() ? 2.0 * inflation * result.deviation[at] : 0.0;
      d.steps[k].parameters.push_back({u.name, u.value, std::clamp(u.value - sigma, u.low, u.value),
                                       std::clamp(u.value + sigma, u.value, u.high)});
      ++at;
    }
  }
}

}  // namespace

Diagnosis diagnose(const chain::Chain& base, const Study& study, const SearchOptions& options) {
  Stopwatch watch;
  Diagnosis d;
  d.relative = study.frequency_responses();
  SearchOptions chosen = options;
  if (study.split()) chosen.most_unknowns = 2;
  d.search = search(base, study.train(), study.holdout(), chosen);
  const Scorer scorer(study, d.search.final);
  d.scored_from = scorer.scored_from();
  d.initial = scorer.size(d.search.initial);
  d.refitted = scorer.size(d.search.base);
  d.final = scorer.size(d.search.final);
  d.floor = d.search.floor;
  for (const auto& s : d.search.steps) d.steps.push_back(step_of(s, scorer));
  if (!d.steps.empty()) d.steps.back().after = d.final;
  add_parameters(d, study.train());
  d.where = where_is(d.search.initial, study, scorer.holdout_from());
  d.remaining_where = where_is(d.search.final, study, scorer.holdout_from());
  d.verdict = verdict_of(d.search, d.search.train_rms, options.enough);
  d.advice = advice_for(d, study);
  d.compute_s = watch.seconds();
  return d;
}

namespace {

Json json_of(const GapSize& s) {
  return {{"train_rms", s.train_rms},
          {"holdout_rms", s.holdout_rms},
          {"holdout_percent_of_range", s.holdout_percent_of_range},
          {"train_whole_record_rms", s.train_whole_rms},
          {"holdout_whole_record_rms", s.holdout_whole_rms}};
}

Json json_of(const std::vector<Cell>& cells) {
  Json all = Json::array();
  for (const auto& c : cells) {
    all.push_back(
        {{"axis", c.axis}, {"from", c.from}, {"to", c.to}, {"share", c.share}, {"extent", c.extent}});
  }
  return all;
}

Json json_of(const Ranked& r) {
  Json values = Json::object();
  if (!r.model.terms().empty()) {
    for (const auto& u : r.model.terms().back().unknowns) values[u.name] = u.value;
  }
  return {{"effect", r.effect->name()},
          {"placed", r.placed},
          {"parameters", values},
          {"train_rms_after", r.train_rms},
          {"holdout_rms_after", r.holdout_rms},
          {"significance", std::clamp(r.z, -1e6, 1e6)},
          {"outcome", r.word}};
}

Json json_of(const DiagnosedStep& s) {
  Json parameters = Json::object();
  for (const auto& p : s.parameters)
    parameters[p.name] = {{"value", p.value}, {"low", p.low}, {"high", p.high}};
  Json j = {{"effect", s.effect},
            {"tied_with", s.tied_with},
            {"also_fitted_with_more_parameters", s.also_fit},
            {"placed", s.placed},
            {"also_placed", s.also_placed},
            {"parameters", parameters},
            {"holdout_rms_before", s.before.holdout_rms},
            {"holdout_rms_after", s.after.holdout_rms},
            {"train_rms_before", s.before.train_rms},
            {"train_rms_after", s.after.train_rms},
            {"significance", std::min(s.significance, 1e6)},
            {"control_gain", s.control_gain}};
  if (!s.runner_up.empty()) {
    j["runner_up"] = {{"effect", s.runner_up},
                      {"holdout_rms_after", s.runner_up_holdout_rms},
                      {"outcome", s.runner_up_word}};
  } else {
    j["runner_up"] = nullptr;
  }
  return j;
}

}  // namespace

Json to_json(const Diagnosis& d) {
  Json j;
  j["noise_floor"] = {{"rms", d.floor.rms}, {"how", d.floor.word()}};
  if (d.floor.how == NoiseFloor::How::unknown) j["noise_floor"]["rms"] = nullptr;
  if (d.floor.how == NoiseFloor::How::periods) {
    j["noise_floor"]["periods"] = d.floor.periods;
    j["noise_floor"]["repeating_odd_rms"] = d.floor.odd_rms;
    j["noise_floor"]["repeating_even_rms"] = d.floor.even_rms;
  }
  j["gap"] = {
      {"initial", json_of(d.initial)}, {"refitted", json_of(d.refitted)}, {"final", json_of(d.final)}};
  if (d.relative) j["gap"]["relative"] = "parts of H_model/H_measured - 1, real and imaginary";
  Json scored = Json::array();
  for (const auto& s : d.scored_from) {
    scored.push_back({{"file", s.file}, {"held_out", s.held_out}, {"scored_from_s", s.from_s}});
  }
  j["scored"] = scored;
  j["where"] = json_of(d.where);
  j["remaining_where"] = json_of(d.remaining_where);
  Json steps = Json::array();
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    steps.push_back(json_of(d.steps[k]));
    Json candidates = Json::array();
    for (const auto& r : d.search.steps[k].ranking) candidates.push_back(json_of(r));
    steps.back()["candidates"] = candidates;
  }
  j["steps"] = steps;
  Json signs = Json::array();
  for (const auto& s : d.search.structure) signs.push_back({{"sign", s.what}, {"times_chance", s.strength}});
  j["signs_of_more"] = signs;
  Json refused = Json::array();
  for (const auto& r : d.search.refused) refused.push_back(json_of(r));
  j["refused"] = refused;
  j["verdict"] = word(d.verdict);
  j["advice"] = d.advice;
  return j;
}

}  // namespace bodesmith::gap
