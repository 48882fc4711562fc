#include "gap/evidence/posterior.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "gap/evidence/score.hpp"

namespace bodesmith::gap {
namespace {

/// Probability of something outside the catalogue where no sign of it is left, and that of the contrary where one is just as plain
/// as chance would make it; a sign twice as plain halves the latter. Chosen, not fitted (docs/gap.md).
constexpr double kOutsideWithoutSign = 0.03;
constexpr double kNotOutsideAtChance = 0.8;
/// Of names told beside something outside: the share that it feigns.
constexpr double kFeigned = 0.15;
/// The best candidates of a round that are looked at.
constexpr std::size_t kCandidates = 8;

/// Probabilities of the names of one step, "" for none.
using Names = std::map<std::string, double>;

Names names_of(const Step& step, const Experiments& train) {
  std::vector<const Model*> models = {&step.before};
  std::vector<std::string> names = {""};
  const auto add = [&](const Effect& effect, const Model& model) {
    names.emplace_back(effect.name());
    models.push_back(&model);
  };
  for (const auto& r : step.ranking) {
    if (models.size() <= kCandidates && !r.no_name && !r.far_fetched) add(*r.effect, r.model);
  }
  const std::string own(step.effect->name());
  if (std::find(names.begin(), names.end(), own) == names.end()) add(*step.effect, step.after);
  auto evidence = log_evidences(models, train);
  for (std::size_t i = 1; i < evidence.size(); ++i) evidence[i] += log_share_of_name();
  const double most = *std::max_element(evidence.begin(), evidence.end());
  if (!std::isfinite(most)) return {{own, 1.0}};
  Names found;
  for (std::size_t i = 0; i < evidence.size(); ++i)
    found[names[i]] = std::max(found[names[i]], std::exp(evidence[i] - most));
  double sum = 0.0;
  for (const auto& [name, weight] : found) sum += weight;
  for (auto& [name, weight] : found) weight /= sum;
  return found;
}

double outside_by(const std::vector<Sign>& signs) {
  double plainest = 1.0;
  for (const auto& sign : signs) plainest = std::max(plainest, sign.strength);
  return signs.empty() ? kOutsideWithoutSign : 1.0 - kNotOutsideAtChance / plainest;
}

bool is_repeatable(const std::string& name) {
  const Effect& effect = effect_registry().get(name);
  return effect.repeatable() || effect.repeatable_in_response();
}

/// All sets of one name a step, most probable first. A name that is there already is no other one: the set is a smaller one and
/// does not pay for it.
std::vector<NamedSet> sets_of(const std::vector<Names>& steps) {
  std::map<std::vector<std::string>, double> sets = {{{}, 1.0}};
  for (const auto& names : steps) {
    std::map<std::vector<std::string>, double> longer;
    for (const auto& [effects, probability] : sets) {
      for (const auto& [name, of_name] : names) {
        auto more = effects;
        double weight = probability * of_name;
        const bool there = std::find(more.begin(), more.end(), name) != more.end();
        if (!name.empty() && there && !is_repeatable(name)) {
          weight *= std::exp(-log_share_of_name());
        } else if (!name.empty()) {
          more.push_back(name);
        }
        longer[more] += weight;
      }
    }
    sets = std::move(longer);
  }
  double sum = 0.0;
  for (const auto& [effects, weight] : sets) sum += weight;
  std::vector<NamedSet> all;
  for (const auto& [effects, weight] : sets) all.push_back({effects, weight / sum});
  std::stable_sort(all.begin(), all.end(),
                   [](const NamedSet& a, const NamedSet& b) { return a.probability > b.probability; });
  return all;
}

}  // namespace

Posterior posterior_of(const SearchResult& result, const Experiments& train) {
  Posterior out;
  out.outside = outside_by(result.structure);
  std::vector<Names> steps;
  for (const auto& step : result.steps) steps.push_back(names_of(step, train));
  const auto sets = sets_of(steps);
  for (const auto& step : result.steps) {
    const std::string own(step.effect->name());
    double held = 0.0;
    for (const auto& set : sets) {
      if (std::find(set.effects.begin(), set.effects.end(), own) != set.effects.end())
        held += set.probability;
    }
    out.of_steps.push_back((1.0 - kFeigned * out.outside) * std::min(1.0, held));
  }
  double held = 0.0;
  for (const auto& set : sets) {
    if (held >= Posterior::kHeld) break;
    held += set.probability;
    out.alternatives.push_back(set);
  }
  return out;
}

}  // namespace bodesmith::gap
