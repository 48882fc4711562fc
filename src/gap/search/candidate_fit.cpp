#include <algorithm>
#include <array>
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

/// Hops to both sides of where a fit ended, as long as the unknown's own and then shorter by these. An edge that crosses a sample
/// changes it whole: the sum of squares comes to its least in a cusp, where a fit stops next to it.
struct Hops {
  double length;
  int count;
};
constexpr std::array kHops = {Hops{1.0, 20}, Hops{0.2, 5}, Hops{0.04, 6}};
/// Of the hollows that they find so many are fitted on from, those that leave no more than this times what the fit left: the other
/// unknowns, which stand as that fit needed them, take as much away. (A late switch leaves all but the same at two delays.)
constexpr std::size_t kHollows = 2;
constexpr double kNearlyAsGood = 1.5;

/// Starts of a proposal that are tried: many of them lie close to each other, and many unknowns are expensive.
std::size_t tries_of(const RoundOptions& options, const Promising& p) {
  const bool many = p.proposal.model.terms().back().unknowns.size() > options.few_unknowns;
  return std::min<std::size_t>(p.best_starts.size(), many ? 1 : p.proposal.starts.size() > 4 ? 3 : 2);
}

/// The proposal's model with its term at one of its starts, and other unknowns as given.
Model with_term_at(const Proposal& proposal, std::vector<double> values, std::size_t start) {
  const auto& own = proposal.starts[start];
  std::copy(own.begin(), own.end(), values.end() - static_cast<std::ptrdiff_t>(own.size()));
  Model model = proposal.model;
  model.set_values(values);
  return model;
}

/// Where fits begin: the term's best starts; and, as the free parameters may have taken over what the new one explains better, once from
/// them as given.
std::vector<Model> starting_models(const SearchSetting& setting, const Promising& p) {
  const auto& proposal = p.proposal;
  const auto here = current_values(proposal.model);
  std::vector<Model> all;
  for (std::size_t t = 0; t < tries_of(setting.options.round, p); ++t)
    all.push_back(with_term_at(proposal, here, p.best_starts[t]));
  const auto& terms = proposal.model.terms();
  const auto given = current_values(setting.initial);
  if (!given.empty() && terms.size() == 1) {
    auto values = here;
    std::copy(given.begin(), given.end(), values.begin());
    all.push_back(with_term_at(proposal, values, p.best_starts[0]));
  }
  return all;
}

/// A few steps from everywhere: the best.
std::optional<FittedModel> begun_fit(const SearchSetting& setting, const SearchRecords& records,
                                     const Promising& p) {
  auto options = fit_options(setting.options, setting.options.round.first_iterations);
  options.cost_tolerance = setting.options.round.first_tolerance;
  std::optional<FittedModel> best;
  for (auto& start : starting_models(setting, p)) {
    if (setting.options.is_late() && best) break;
    auto fitted = fit(std::move(start), records.look(), options);
    if (fitted.usable() && (!best || fitted.rms < best->rms)) best = std::move(fitted);
  }
  return best;
}

/// A fit of one of the candidates.
struct Racer {
  std::size_t candidate = 0;
  FittedModel now;
};

double least_rms(const std::vector<Racer>& racers) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& r : racers) least = std::min(least, r.now.rms);
  return least;
}

/// On to the end of all that are in the running.
void fit_to_the_end(const SearchSetting& setting, const SearchRecords& records, std::vector<Racer>& racers) {
  auto options = fit_options(setting.options, setting.options.iterations);
  options.cost_tolerance = setting.options.round.tolerance;
  const double leader = least_rms(racers);
  parallel_for(racers.size(), setting.options.threads, [&](std::size_t i) {
    auto& now = racers[i].now;
    if (setting.options.is_late() || now.rms > setting.options.round.far_behind * leader) return;
    auto fitted = fit(now.model, records.look(), options);
    if (fitted.usable() && fitted.rms <= now.rms) now = std::move(fitted);
  });
}

/// Values around the one that unknown `at` has, the others as they are, at which less is left than at their neighbours: those that leave
/// least first.
std::vector<double> hollows_around(Runner& runner, std::vector<double> values, std::size_t at,
                                   const Unknown& u, Hops hops, double most) {
  const double middle = values[at];
  std::vector<double> place, left, residual;
  for (int k = -hops.count; k <= hops.count; ++k) {
    place.push_back(std::clamp(middle + hops.length * u.hop * k, u.low, u.high));
    values[at] = place.back();
    left.push_back(runner(values, residual) ? rms(residual) : std::numeric_limits<double>::infinity());
  }
  std::vector<std::pair<double, double>> hollows;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const bool lowest = (i == 0 || left[i] <= left[i - 1]) && (i + 1 == left.size() || left[i] < left[i + 1]);
    if (lowest && left[i] < most && place[i] != middle) hollows.emplace_back(left[i], place[i]);
  }
  std::sort(hollows.begin(), hollows.end());
  std::vector<double> out;
  for (const auto& [rms_there, value] : hollows) out.push_back(value);
  return out;
}

/// Values that a fit cannot slide along, tried coarsely and finely around where it ended, then fitted on.
void comb(const SearchSetting& setting, const SearchRecords& records, Racer& racer) {
  const auto unknowns = racer.now.model.unknowns();
  auto options = fit_options(setting.options, setting.options.refit_iterations);
  for (std::size_t at = 0; at < unknowns.size(); ++at) {
    if (unknowns[at].hop <= 0.0 || setting.options.is_late()) continue;
    for (const auto& hops : kHops) {
      Runner runner(racer.now.model, records.look());
      const auto values = current_values(racer.now.model);
      auto hollows = hollows_around(runner, values, at, unknowns[at], hops, kNearlyAsGood * racer.now.rms);
      hollows.resize(std::min(hollows.size(), kHollows));
      for (const double hollow : hollows) {
        auto moved = values;
        moved[at] = hollow;
        Model model = racer.now.model;
        model.set_values(moved);
        auto fitted = fit(std::move(model), records.look(), options);
        if (fitted.usable() && fitted.rms < racer.now.rms) racer.now = std::move(fitted);
      }
    }
  }
}

/// The same for all that are in the running.
void comb_leaders(const SearchSetting& setting, const SearchRecords& records, std::vector<Racer>& racers) {
  const double leader = least_rms(racers);
  parallel_for(racers.size(), setting.options.threads, [&](std::size_t i) {
    if (racers[i].now.rms < setting.options.round.far_behind * leader) comb(setting, records, racers[i]);
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
  comb_leaders(setting, records, racers);
  std::vector<std::optional<Ranked>> ranked(candidates.size());
  parallel_for(racers.size(), options.threads, [&](std::size_t i) {
    const auto& candidate = candidates[racers[i].candidate];
    const auto& term = candidate.proposal.model.terms().back();
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
