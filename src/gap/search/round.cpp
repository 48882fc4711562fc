#include "gap/search/round.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

const Effect* effect_of(const Proposal& proposal) {
  return proposal.model.terms().back().effect;
}

/// Twice the same is one term with more freedom than it says.
bool repeats_earlier_term(const Proposal& proposal) {
  const auto& terms = proposal.model.terms();
  const auto* effect = terms.back().effect;
  return !effect->repeatable() && std::any_of(terms.begin(), terms.end() - 1,
                                              [&](const Term& earlier) { return earlier.effect == effect; });
}

/// What every effect promises when the search stands at this model, best first.
std::vector<Promising> look_from(const SearchSetting& setting, const SearchRecords& records,
                                 const Model& model, const EffectFilter& filter) {
  const auto scene = make_scene(model, records.train);
  std::vector<Proposal> proposals;
  for (const auto* effect : effect_registry().all()) {
    if (scene.frequency_only && !effect->linear()) continue;
    if (filter && !filter(*effect)) continue;
    effect->propose(scene, proposals);
  }
  std::erase_if(proposals, repeats_earlier_term);
  return shortlist(model, std::move(proposals), records.look(), setting.options.threads);
}

/// The best places of each effect, one more when it is of another form (number of unknowns), of the best
/// effects.
class Choice {
 public:
  explicit Choice(const RoundOptions& options) : options_(options) {}

  /// Goes on until `max_effects` are chosen in all; those in `done` are passed over.
  void add(std::vector<Promising> promising, std::size_t max_effects, const std::set<const Effect*>& done) {
    for (auto& p : promising) {
      const auto* effect = effect_of(p.proposal);
      if (p.score < options_.min_score || done.count(effect) != 0) continue;
      const std::size_t form = p.proposal.model.terms().back().unknowns.size();
      const bool new_form = forms_[effect].count(form) == 0;
      if (places_[effect] >= options_.places + (new_form ? 1 : 0)) continue;
      if (effects_.count(effect) == 0 && effects_.size() >= max_effects) continue;
      effects_.insert(effect);
      ++places_[effect];
      forms_[effect].insert(form);
      chosen_.push_back(std::move(p));
    }
  }
  /// The chosen effects that another look has nothing to add to; the others may have as many places once
  /// more.
  std::set<const Effect*> close_for_another_look() {
    auto done = effects_;
    for (const auto* effect : effects_) {
      if (!effect->starts_from_residual()) continue;
      done.erase(effect);
      places_[effect] = 0;
    }
    return done;
  }
  const std::vector<Promising>& chosen() const { return chosen_; }

 private:
  const RoundOptions& options_;
  std::map<const Effect*, int> places_;
  std::map<const Effect*, std::set<std::size_t>> forms_;
  std::set<const Effect*> effects_;
  std::vector<Promising> chosen_;
};

/// Fits the leaders, whose fits saw only stretches, on the whole records.
void fit_leaders_on_all(const SearchSetting& setting, const SearchRecords& records,
                        const RoundResiduals& before, std::vector<Ranked>& ranking) {
  const auto& options = setting.options;
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const Ranked& a, const Ranked& b) { return a.holdout_rms < b.holdout_rms; });
  const std::size_t leaders = std::min(options.stretches.leaders, ranking.size());
  parallel_for(leaders, options.threads, [&](std::size_t i) {
    if (options.stopped()) return;
    Ranked better = ranking[i];
    auto fitted = fit(better.model, records.train, fit_options(options, options.stretches.iterations_on_all));
    if (!fitted.result.usable()) return;
    better.model = std::move(fitted.model);
    better.condition_number = fitted.result.condition_number;
    if (auto judged = with_gains(std::move(better), records, before)) ranking[i] = std::move(*judged);
  });
}

}  // namespace

std::vector<Ranked> fit_round(const SearchSetting& setting, const SearchRecords& records, const Model& model,
                              const EffectFilter& filter) {
  const auto& options = setting.options;
  Choice choice(options.round);
  choice.add(look_from(setting, records, model, filter), options.round.effects, {});
  if (options.stopped()) return {};
  if (model.terms().empty() && model.free_count() > 0 && !records.are_long()) {
    // Free parameters that took over a missing effect's share hide it: a few more, as they look from the
    // parameters that were given.
    const auto done = choice.close_for_another_look();
    choice.add(look_from(setting, records, setting.initial, filter),
               options.round.effects + options.round.effects_from_given, done);
    if (options.stopped()) return {};
  }
  const RoundResiduals before{residuals_of(model, records.train), residuals_of(model, records.holdout)};
  std::vector<std::optional<Ranked>> fitted(choice.chosen().size());
  parallel_for(fitted.size(), options.threads, [&](std::size_t i) {
    fitted[i] = fit_candidate(setting, records, choice.chosen()[i], before);
  });
  std::vector<Ranked> ranking;
  for (auto& r : fitted) {
    if (r) ranking.push_back(std::move(*r));
  }
  if (records.are_long()) fit_leaders_on_all(setting, records, before, ranking);
  return ranking;
}

}  // namespace bodesmith::gap
