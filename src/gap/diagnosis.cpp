#include "gap/diagnosis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/progress.hpp"
#include "gap/model/model_fit.hpp"
#include "gap/runner.hpp"
#include "numeric/index.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {

std::string to_string(Verdict verdict) {
  constexpr std::array kWords = {"explained", "partly_explained", "nothing_missing", "unexplained",
                                 "interrupted"};
  return kWords.at(static_cast<std::size_t>(verdict));
}

Verdict verdict_of(const SearchResult& result) {
  if (result.stopped) return Verdict::interrupted;
  const bool left = result.train_rms > result.floor.most_noise || !result.structure.empty();
  if (result.steps.empty()) return left ? Verdict::unexplained : Verdict::nothing_missing;
  return left ? Verdict::partly_explained : Verdict::explained;
}

const Ranked* runner_up_of(const Step& step) {
  const Ranked* rival = nullptr;
  for (const auto& r : step.ranking) {
    if (r.effect->told() != step.effect->told() && (rival == nullptr || r.log_evidence > rival->log_evidence))
      rival = &r;
  }
  return rival;
}

namespace {

/// What the candidates leave of the held-out records, for the tables.
void look_at_holdout(std::vector<Ranked>& ranking, const Experiments& holdout) {
  parallel_for(ranking.size(), allowed_threads(),
               [&](std::size_t i) { ranking[i].holdout_rms = rms_of(ranking[i].model, holdout); });
}

/// Values of the final model's terms, term by term.
std::vector<std::vector<FoundParameter>> found_parameters(const Model& model, const Experiments& train) {
  const auto result = held_by(model, train);
  const double inflation =
      result.residuals.size() > 0 ? std::sqrt(correlation_time(to_vector(result.residuals))) : 1.0;
  const auto lines = model.line_blocks();
  std::vector<std::vector<FoundParameter>> all;
  for (const auto& term : model.terms()) {
    std::size_t at = model.first_unknown_of(all.size());
    auto& parameters = all.emplace_back();
    for (const auto& u : term.unknowns) {
      const double sigma = eigen_index(at) < result.deviation.size()
                               ? 2.0 * inflation * result.deviation(eigen_index(at))
                               : 0.0;
      parameters.push_back({u.name, u.value, std::clamp(u.value - sigma, u.low, u.value),
                            std::clamp(u.value + sigma, u.value, u.high)});
      ++at;
    }
    for (int id : term.blocks) {
      if (std::ranges::count(lines, id) == 0) continue;
      const auto& line = model.at(model.position_of(id));
      for (const char* key : {"amplitude", "phase_deg"})
        parameters.push_back({key, line.get(key), line.get(key), line.get(key)});
    }
  }
  return all;
}

/// Parameters whose interval is wider than the value itself.
std::vector<OpenParameter> open_parameters(const Diagnosis& d) {
  std::vector<OpenParameter> open;
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    const auto& unknowns = d.search.final.terms()[k].unknowns;
    // Of many unknowns (weights of plays) each alone may be open without the effect being so.
    for (std::size_t j = 0; j < unknowns.size() && unknowns.size() <= kFew; ++j) {
      const auto& p = d.steps[k].parameters[j];
      if (p.high - p.low > std::abs(p.value))
        open.push_back({d.search.final.first_unknown_of(k) + j, p.name, p.low, p.high});
    }
  }
  return open;
}

/// Whether the held-out records contradict what was found on the others.
bool disagrees(const Diagnosis& d) {
  const bool worse = !d.steps.empty() && d.final.holdout_rms > d.refitted.holdout_rms;
  return worse || d.final.holdout_rms > kFarMore * d.final.train_rms;
}

/// What the names leave of the held-out records' gap: all of it where none was found and more is left, none where nothing is missing.
double share_left(const Diagnosis& d, bool more_is_left) {
  if (d.steps.empty()) return more_is_left ? 1.0 : 0.0;
  return d.final.holdout_rms / d.refitted.holdout_rms;
}

}  // namespace

Diagnosis diagnose(const chain::Chain& base, const Study& given, const SearchOptions& options) {
  const ThreadAllowance allowance(options.threads);
  Stopwatch watch;
  Study study = given;
  Diagnosis d;
  d.relative = study.frequency_responses();
  d.weighted = study.weighted();
  d.amplitude = amplitude_dependence(study.train());
  Experiments searched = d.amplitude ? of_least_drive(study.train()) : study.train();
  std::tie(d.search, d.start) = search_from_start(base, searched, options);
  study.set_holds(d.search.holds);
  set_holds(searched, d.search.holds);
  if (d.amplitude) d.search.structure.push_back({SignKind::depends_on_amplitude, d.amplitude->strength});
  // The held-out records come in here, when all is decided. Lines of the mains are written as the first of
  // them has them.
  d.search.final = with_lines_of(std::move(d.search.final), study.holdout().front());
  const WholeResiduals initial = whole_residuals(d.search.initial, study);
  const WholeResiduals final = whole_residuals(d.search.final, study);
  const GapMeter meter(study, final);
  for (auto& s : d.search.steps) look_at_holdout(s.ranking, meter.holdout());
  look_at_holdout(d.search.refused, meter.holdout());
  d.scored_from = meter.scored_from();
  d.initial = meter.size(initial);
  d.final = meter.size(final);
  d.refitted = d.search.steps.empty() ? d.final : meter.size(whole_residuals(d.search.base, study));
  d.floor = d.search.floor;
  auto parameters = found_parameters(d.search.final, searched);
  for (std::size_t k = 0; k < d.search.steps.size(); ++k) {
    const Step& step = d.search.steps[k];
    d.steps.push_back(
        {.effect = std::string(step.effect->told()),
         .tied_with = step.tied_with,
         .placed = step.placed,
         .also_placed = step.also_placed,
         .part = d.search.final.terms()[k].part,
         .parameters = std::move(parameters[k]),
         .after = k + 1 < d.search.steps.size() ? meter.size(whole_residuals(step.after, study)) : d.final});
  }
  d.where = meter.where(initial);
  d.remaining_where = meter.where(final);
  d.constant_offsets = constant_offsets(meter, final, study);
  d.verdict = verdict_of(d.search);
  d.holdout_disagrees = disagrees(d);
  // What is claimed of the training records and does not hold elsewhere is not so.
  if (d.holdout_disagrees) {
    if (d.verdict == Verdict::explained) d.verdict = Verdict::partly_explained;
    if (d.verdict == Verdict::nothing_missing) d.verdict = Verdict::unexplained;
  }
  const bool more_is_left = d.verdict == Verdict::partly_explained || d.verdict == Verdict::unexplained;
  auto posterior = posterior_of(d.search, more_is_left, share_left(d, more_is_left));
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    d.steps[k].among_names = posterior.among_names[k];
    d.steps[k].probability = (1.0 - posterior.outside) * posterior.among_names[k];
  }
  d.alternatives = std::move(posterior.alternatives);
  d.outside = posterior.outside;
  if (!d.search.stopped)
    d.next_experiment = next_experiment(d.search, open_parameters(d), study, options.drive);
  d.advice = advice_for(d, study);
  d.compute_s = watch.seconds();
  return d;
}

}  // namespace bodesmith::gap
