#include <algorithm>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/round.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Starts of a proposal that are tried: many of them lie close to each other.
std::size_t tries_of(const Promising& p) {
  return std::min<std::size_t>(p.best_starts.size(), p.proposal.starts.size() > 4 ? 3 : 2);
}

/// The proposal's model with its term at one of its starts, and other unknowns as given.
Model with_term_at(const Proposal& proposal, std::vector<double> values, std::size_t start) {
  const auto& own = proposal.starts[start];
  std::copy(own.begin(), own.end(), values.end() - static_cast<std::ptrdiff_t>(own.size()));
  Model model = proposal.model;
  model.set_values(values);
  return model;
}

/// Where fits begin: the term's best starts; and, as earlier terms and the free parameters may have taken
/// over what the new one explains better, once with the last earlier term made weak and once from the
/// parameters as given.
std::vector<Model> starting_models(const SearchSetting& setting, const Promising& p) {
  const auto& proposal = p.proposal;
  const auto here = current_values(proposal.model);
  std::vector<Model> all;
  for (std::size_t t = 0; t < tries_of(p); ++t) all.push_back(with_term_at(proposal, here, p.best_starts[t]));
  const auto& terms = proposal.model.terms();
  if (terms.size() > 1) {
    const std::size_t last_earlier = terms.size() - 2;
    const auto& u = terms[last_earlier].unknowns.front();
    if (u.logarithmic) {
      auto values = here;
      double& value = values[proposal.model.first_unknown_of(last_earlier)];
      const double factor = setting.options.round.weakened;
      value = std::clamp(u.weak_when_large() ? value * factor : value / factor, u.low, u.high);
      all.push_back(with_term_at(proposal, values, p.best_starts[0]));
    }
  }
  const auto given = current_values(setting.initial);
  if (!given.empty()) {
    auto values = here;
    std::copy(given.begin(), given.end(), values.begin());
    all.push_back(with_term_at(proposal, values, p.best_starts[0]));
  }
  return all;
}

/// A few steps from everywhere, best first.
std::vector<FittedModel> begin_fits(const SearchSetting& setting, const SearchRecords& records,
                                    const Promising& p) {
  auto options = fit_options(setting.options, setting.options.round.first_iterations);
  options.cost_tolerance = setting.options.round.first_tolerance;
  std::vector<FittedModel> begun;
  for (auto& start : starting_models(setting, p)) {
    if (setting.options.stopped() && !begun.empty()) break;
    auto fitted = fit(std::move(start), records.look(), options);
    if (fitted.result.usable()) begun.push_back(std::move(fitted));
  }
  std::stable_sort(begun.begin(), begun.end(),
                   [](const FittedModel& a, const FittedModel& b) { return a.result.rms < b.result.rms; });
  return begun;
}

}  // namespace

std::optional<Ranked> with_gains(Ranked r, const SearchRecords& records, const RoundResiduals& before) {
  const auto train = residuals_of(r.model, records.train);
  const auto holdout = residuals_of(r.model, records.holdout);
  if (train.size() != before.train.size() || holdout.size() != before.holdout.size()) return std::nullopt;
  r.effective = r.model.terms().back().effective_unknowns();
  r.train_rms = rms(train);
  r.holdout_rms = rms(holdout);
  r.train_z = improvement_z(before.train, train);
  r.z = improvement_z(before.holdout, holdout);
  return r;
}

std::optional<Ranked> fit_candidate(const SearchSetting& setting, const SearchRecords& records,
                                    const Promising& p, const RoundResiduals& before) {
  const auto& limits = setting.options.round;
  const auto& term = p.proposal.model.terms().back();
  const bool free = term.unknowns.size() > limits.free_unknowns;
  auto options = fit_options(setting.options, free ? limits.iterations_when_free : limits.iterations);
  options.cost_tolerance = limits.tolerance;
  auto begun = begin_fits(setting, records, p);
  std::optional<FittedModel> best;
  for (std::size_t t = 0; t < std::min<std::size_t>(begun.size(), 2); ++t) {
    // begun[0] is still as it was begun: fits are made on copies.
    if (t > 0 &&
        (begun[t].result.rms > limits.worth_going_on * begun[0].result.rms || setting.options.stopped()))
      break;
    auto fitted = fit(begun[t].model, records.look(), options);
    if (!fitted.result.usable() || (best && !(fitted.result.rms < best->result.rms))) continue;
    best = std::move(fitted);
  }
  if (!best) return std::nullopt;
  Ranked r;
  r.effect = term.effect;
  r.placed = term.placed;
  r.score = p.score;
  r.unknowns = term.unknowns.size();
  r.model = std::move(best->model);
  r.condition_number = best->result.condition_number;
  return with_gains(std::move(r), records, before);
}

}  // namespace bodesmith::gap
