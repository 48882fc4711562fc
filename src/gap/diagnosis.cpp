#include "gap/diagnosis.hpp"

#include <algorithm>
#include <cmath>

#include "base/progress.hpp"
#include "gap/least_squares.hpp"
#include "gap/runner.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Unknowns of one term when nothing with another excitation is held out.
constexpr std::size_t kMaxUnknownsWhenSplit = 2;

const Ranked* best_rival(const Step& step) {
  const Ranked* rival = nullptr;
  for (const auto& r : step.ranking) {
    if (r.effect != step.effect && (rival == nullptr || r.holdout_rms < rival->holdout_rms)) rival = &r;
  }
  return rival;
}

DiagnosedStep describe(const Step& step, const GapMeter& meter) {
  DiagnosedStep s;
  s.effect = step.effect->name();
  s.tied_with = step.tied_with;
  s.also_fit = step.also_fit;
  s.placed = step.placed;
  s.also_placed = step.also_placed;
  s.before = meter.size(step.before);
  s.after = meter.size(step.after);
  s.control_gain = step.control_gain;
  for (const auto& r : step.ranking) {
    if (r.effect == step.effect && r.outcome == CandidateOutcome::named) s.significance = r.z;
  }
  if (const auto* rival = best_rival(step)) {
    s.runner_up = {std::string(rival->effect->name()), meter.size(rival->model).holdout_rms, rival->outcome};
  }
  return s;
}

/// Values of the final model's terms, term by term.
std::vector<std::vector<FoundParameter>> found_parameters(const Model& model, const Experiments& train) {
  Runner runner(model, train);
  LeastSquaresOptions options;
  options.iterations = 1;
  const auto result = least_squares(
      model.unknowns(), [&](std::span<const double> v, std::vector<double>& out) { return runner(v, out); },
      options);
  const double inflation = result.usable() ? std::sqrt(correlation_time(result.residuals)) : 1.0;
  std::vector<std::vector<FoundParameter>> all;
  std::size_t at = model.free_count();
  for (const auto& term : model.terms()) {
    auto& parameters = all.emplace_back();
    for (const auto& u : term.unknowns) {
      const double sigma =
          result.usable() && at < result.deviation.size() ? 2.0 * inflation * result.deviation[at] : 0.0;
      parameters.push_back({u.name, u.value, std::clamp(u.value - sigma, u.low, u.value),
                            std::clamp(u.value + sigma, u.value, u.high)});
      ++at;
    }
  }
  return all;
}

}  // namespace

Diagnosis diagnose(const chain::Chain& base, const Study& study, const SearchOptions& options) {
  Stopwatch watch;
  Diagnosis d;
  d.relative = study.frequency_responses();
  SearchOptions chosen = options;
  if (study.split()) chosen.acceptance.max_unknowns = kMaxUnknownsWhenSplit;
  d.search = search(base, study.train(), study.holdout(), chosen);
  const GapMeter meter(study, d.search.final);
  d.scored_from = meter.scored_from();
  d.initial = meter.size(d.search.initial);
  d.refitted = meter.size(d.search.base);
  d.final = meter.size(d.search.final);
  d.floor = d.search.floor;
  for (const auto& s : d.search.steps) d.steps.push_back(describe(s, meter));
  if (!d.steps.empty()) d.steps.back().after = d.final;
  auto parameters = found_parameters(d.search.final, study.train());
  for (std::size_t k = 0; k < parameters.size() && k < d.steps.size(); ++k)
    d.steps[k].parameters = std::move(parameters[k]);
  d.where = meter.where(d.search.initial);
  d.remaining_where = meter.where(d.search.final);
  d.verdict = verdict_of(d.search, d.search.train_rms, options.enough);
  d.advice = advice_for(d, study);
  d.compute_s = watch.seconds();
  return d;
}

}  // namespace bodesmith::gap
