#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "gap/evidence/score.hpp"
#include "gap/runner.hpp"
#include "gap/search/round.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Hops (Unknown::hop) to both sides of where a fit ended. An edge that crosses a sample changes it whole: the sum of squares comes to its
/// least in a cusp, where a fit stops next to it.
constexpr int kHops = 20;

/// Starts of a proposal that are tried, those that promise most and the one that leaves least: many of them lie close to each other, and
/// many unknowns are expensive.
std::size_t tries_of(const RoundOptions& options, const Promising& p) {
  const bool many = p.proposal.term().unknowns.size() >= options.many_unknowns;
  return std::min<std::size_t>(p.best_starts.size(), many ? 1 : p.proposal.starts.size() > 4 ? 4 : 3);
}

/// The proposal's model with its term at one of its starts, and other unknowns as they stand.
Model with_term_at(const Proposal& proposal, std::size_t start) {
  auto values = current_values(proposal.model);
  const auto& own = proposal.starts[start];
  std::copy(own.begin(), own.end(), values.end() - static_cast<std::ptrdiff_t>(own.size()));
  Model model = proposal.model;
  model.set_values(values);
  return model;
}

/// A few steps from each of the term's best starts: the best.
std::optional<FittedModel> begun_fit(const SearchSetting& setting, const SearchRecords& records,
                                     const Promising& p) {
  const auto options = fit_options(setting.options, setting.options.few_iterations);
  std::optional<FittedModel> best;
  for (std::size_t t = 0; t < tries_of(setting.options.round, p); ++t) {
    if (setting.options.is_late() && best) break;
    auto fitted = fit(with_term_at(p.proposal, p.best_starts[t]), records.look(), options);
    if (fitted.usable() && (!best || fitted.rms < best->rms)) best = std::move(fitted);
  }
  return best;
}

/// A fit of one of the candidates.
struct Racer {
  std::size_t candidate = 0;
  FittedModel now;
};

/// The value around the one that unknown `at` has, the others as they are, at which least is left; nothing where that is it.
std::optional<double> least_around(const FittedModel& now, const Experiments& look, std::size_t at,
                                   const Unknown& u) {
  Runner runner(now.model, look);
  auto values = current_values(now.model);
  const double middle = values[at];
  double least = now.rms;
  std::optional<double> best;
  std::vector<double> residual;
  for (int k = -kHops; k <= kHops; ++k) {
    values[at] = std::clamp(middle + u.hop * k, u.low, u.high);
    if (values[at] == middle || !runner(values, residual) || !(rms(residual) < least)) continue;
    least = rms(residual);
    best = values[at];
  }
  return best;
}

/// Values that a fit cannot slide along, tried around where it ended, then fitted on.
void comb(const SearchSetting& setting, const SearchRecords& records, Racer& racer) {
  const auto unknowns = racer.now.model.unknowns();
  const auto options = fit_options(setting.options, setting.options.refit_iterations);
  for (std::size_t at = 0; at < unknowns.size(); ++at) {
    if (!unknowns[at].moves_edges() || setting.options.is_late()) continue;
    const auto better = least_around(racer.now, records.look(), at, unknowns[at]);
    if (!better) continue;
    auto moved = current_values(racer.now.model);
    moved[at] = *better;
    Model model = racer.now.model;
    model.set_values(moved);
    auto fitted = fit(std::move(model), records.look(), options);
    if (fitted.usable() && fitted.rms < racer.now.rms) racer.now = std::move(fitted);
  }
}

/// On to the end of all that are in the running.
void fit_to_the_end(const SearchSetting& setting, const SearchRecords& records, std::vector<Racer>& racers) {
  const auto options = fit_options(setting.options, setting.options.iterations);
  double leader = std::numeric_limits<double>::infinity();
  for (const auto& r : racers) leader = std::min(leader, r.now.rms);
  parallel_for(racers.size(), setting.options.threads, [&](std::size_t i) {
    auto& now = racers[i].now;
    if (setting.options.is_late() || now.rms > setting.options.round.far_behind * leader) return;
    auto fitted = fit(now.model, records.look(), options);
    if (fitted.usable() && fitted.rms <= now.rms) now = std::move(fitted);
    comb(setting, records, racers[i]);
  });
}

}  // namespace

std::vector<std::optional<Ranked>> fit_candidates(const SearchSetting& setting, const SearchRecords& records,
                                                  const std::vector<Promising>& candidates) {
  const auto& options = setting.options;
  std::vector<std::optional<FittedModel>> begun(candidates.size());
  parallel_for(candidates.size(), options.threads, [&](std::size_t i) {
    if (!options.is_late()) begun[i] = begun_fit(setting, records, candidates[i]);
  });
  std::vector<Racer> racers;
  for (std::size_t i = 0; i < begun.size(); ++i) {
    if (begun[i]) racers.push_back({i, std::move(*begun[i])});
  }
  fit_to_the_end(setting, records, racers);
  std::vector<std::optional<Ranked>> ranked(candidates.size());
  parallel_for(racers.size(), options.threads, [&](std::size_t i) {
    const auto& candidate = candidates[racers[i].candidate];
    const auto& term = candidate.proposal.term();
    Ranked r;
    r.effect = term.effect;
    r.placed = term.placed;
    r.score = candidate.score;
    r.model = std::move(racers[i].now.model);
    r.model.set_log_prior(r.model.terms().size() - 1,
                          log_share_of_name() - std::log(static_cast<double>(candidate.places)));
    r.train_rms = rms_of(r.model, records.train);
    if (std::isfinite(r.train_rms)) ranked[racers[i].candidate] = std::move(r);
  });
  return ranked;
}

}  // namespace bodesmith::gap
