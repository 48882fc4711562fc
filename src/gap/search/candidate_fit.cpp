#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gap/evidence/score.hpp"
#include "gap/runner.hpp"
#include "gap/search/round.hpp"
#include "numeric/index.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Hops (Unknown::hop) to both sides of where a fit ended. An edge that crosses a sample changes it whole: the sum of squares comes to its
/// least in a cusp, where a fit stops next to it.
constexpr int kHops = 20;

/// The proposal's model with its term at one of its starts, and other unknowns as they stand.
Model with_term_at(const Proposal& proposal, std::size_t start) {
  auto values = proposal.model.values();
  const auto& own = proposal.starts[start];
  std::copy(own.begin(), own.end(), values.end() - static_cast<std::ptrdiff_t>(own.size()));
  Model model = proposal.model;
  model.set_values(values);
  return model;
}

/// The base model's own values as they were given, where one stands further off than these are right to: what is missing has bent it, and
/// a fit from there may leave that block to another name. Nothing where none does.
std::optional<Model> as_given(Model model) {
  auto values = model.values();
  const auto unknowns = model.unknowns();
  bool bent = false;
  for (std::size_t k = 0; k < model.free_count(); ++k) {
    if (!(unknowns[k].given_spread > 0.0)) continue;
    bent = bent || std::abs(unknowns[k].deviations(values[k])) > 1.0;
    values[k] = unknowns[k].given;
  }
  if (!bent) return std::nullopt;
  model.set_values(values);
  return model;
}

/// A few steps from each of the term's best starts, and from the best of them with the base model as given: the best.
std::optional<FittedModel> begun_fit(const SearchSetting& setting, const SearchRecords& records,
                                     const Promising& p) {
  const auto options = few_steps(setting.options);
  const std::size_t tries = p.proposal.term().unknowns.size() > 2 * kFew ? 1 : kFew;
  std::vector<Model> starts;
  for (const std::size_t start : std::span(p.best_starts).first(std::min(tries, p.best_starts.size())))
    starts.push_back(with_term_at(p.proposal, start));
  if (auto given = as_given(starts.front())) starts.push_back(std::move(*given));
  std::vector<std::optional<FittedModel>> fitted(starts.size());
  parallel_for(starts.size(), allowed_threads(), [&](std::size_t i) {
    if (i == 0 || !setting.options.is_late()) fitted[i] = fit(std::move(starts[i]), records.look(), options);
  });
  std::optional<FittedModel> best;
  for (auto& one : fitted) {
    if (one && one->usable() && (!best || one->rms < best->rms)) best = std::move(one);
  }
  return best;
}

/// The value around the one that unknown `at` has, the others as they are, at which least is left; nothing where that is it.
std::optional<double> least_around(const FittedModel& now, const Experiments& look, std::size_t at,
                                   const Unknown& u) {
  Runner runner(now.model, look);
  const auto values = now.model.values();
  const auto moved = [&](std::size_t i) {
    return std::clamp(values[at] + u.hop * (static_cast<double>(i) - kHops), u.low, u.high);
  };
  std::vector<double> left(2 * kHops + 1, std::numeric_limits<double>::infinity());
  parallel_for(left.size(), allowed_threads(), [&](std::size_t i) {
    auto hopped = values;
    hopped[at] = moved(i);
    std::vector<double> residual;
    if (hopped[at] != values[at] && runner(hopped, residual)) left[i] = rms(residual);
  });
  const auto least = std::ranges::min_element(left);
  if (!(*least < now.rms)) return std::nullopt;
  return moved(std_index(least - left.begin()));
}

/// Values that a fit cannot slide along, tried around where it ended, then fitted on.
void comb(const SearchSetting& setting, const SearchRecords& records, FittedModel& now) {
  const auto unknowns = now.model.unknowns();
  const auto options = fit_options(setting.options);
  for (std::size_t at = 0; at < unknowns.size(); ++at) {
    if (!unknowns[at].moves_edges() || setting.options.is_late()) continue;
    const auto better = least_around(now, records.look(), at, unknowns[at]);
    if (!better) continue;
    auto moved = now.model.values();
    moved[at] = *better;
    Model model = now.model;
    model.set_values(moved);
    auto fitted = fit(std::move(model), records.look(), options);
    if (fitted.usable() && fitted.rms < now.rms) now = std::move(fitted);
  }
}

/// On to the end.
Ranked ended_fit(const SearchSetting& setting, const SearchRecords& records, const Promising& candidate,
                 FittedModel now, double leader) {
  if (!setting.options.is_late() && now.rms <= kFarMore * leader) {
    auto options = fit_options(setting.options);
    options.cost_tolerance = least_telling_drop(records.look());
    auto fitted = fit(now.model, records.look(), options);
    if (fitted.usable() && fitted.rms <= now.rms) now = std::move(fitted);
    comb(setting, records, now);
  }
  Ranked r;
  r.effect = candidate.proposal.term().effect;
  r.placed = candidate.proposal.term().placed;
  r.score = candidate.score;
  r.model = std::move(now.model);
  r.model.set_log_prior(r.model.terms().size() - 1,
                        log_share_of_name() - std::log(static_cast<double>(candidate.places)));
  r.train_rms = rms_of(r.model, records.train);
  return r;
}

}  // namespace

std::vector<std::optional<Ranked>> fit_candidates(const SearchSetting& setting, const SearchRecords& records,
                                                  const std::vector<Promising>& candidates) {
  const auto& options = setting.options;
  std::vector<std::optional<FittedModel>> begun(candidates.size());
  parallel_for(candidates.size(), allowed_threads(), [&](std::size_t i) {
    if (!options.is_late()) begun[i] = begun_fit(setting, records, candidates[i]);
  });
  double leader = std::numeric_limits<double>::infinity();
  for (const auto& fitted : begun) leader = std::min(leader, fitted ? fitted->rms : leader);
  std::vector<std::optional<Ranked>> ranked(candidates.size());
  parallel_for(candidates.size(), allowed_threads(), [&](std::size_t i) {
    if (!begun[i]) return;
    auto r = ended_fit(setting, records, candidates[i], std::move(*begun[i]), leader);
    if (std::isfinite(r.train_rms)) ranked[i] = std::move(r);
  });
  return ranked;
}

}  // namespace bodesmith::gap
