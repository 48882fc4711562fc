#include "gap/evidence/posterior.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "gap/evidence/score.hpp"

namespace bodesmith::gap {
namespace {

// Fitted to drawn cases of two generators, one in fourteen of them with something outside the catalogue (bench/calibration.py; docs/gap.md
// shows what they make of others): the first to 280 of this build, the second to 449, the last to 756 of five before.
/// Probability that no set of the catalogue is the whole answer where the verdict is that nothing is left: of 411 names told so by this
/// build one in forty-six is wrong. Twice as much: no name above .95.
constexpr double kOutsideOfAWhole = 0.03;
/// Of the contrary where a sign is just as plain as chance would make it; a sign twice as plain halves it. Twice as much: of names alongside a
/// sign, told at .64 in the mean, .35 were right.
constexpr double kNotOutsideAtChance = 0.3;
/// Of names told alongside something outside: the share that it feigns. With .6 those told at .58 were right in .43 of 21, with 1 none is told.
constexpr double kFeigned = 0.8;
double outside_by(const std::vector<Sign>& signs) {
  double plainest = 1.0;
  for (const auto& sign : signs) plainest = std::max(plainest, sign.strength);
  return 1.0 - kNotOutsideAtChance / plainest;
}

bool is_repeatable(const std::string& name) {
  return effect_registry().get(name).facts().may_repeat(true);
}

/// All sets of one name a step, most probable first. A name that is there already is no other one: the set is a smaller one and
/// does not pay for it.
std::vector<NamedSet> sets_of(const std::vector<std::map<std::string, double>>& steps) {
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

Posterior posterior_of(const SearchResult& result, bool more_is_left) {
  Posterior out;
  out.outside = more_is_left ? outside_by(result.structure) : kOutsideOfAWhole;
  std::vector<std::map<std::string, double>> steps;
  for (const auto& step : result.steps) steps.push_back(names_of_step(step));
  const auto sets = sets_of(steps);
  for (const auto& step : result.steps) {
    const std::string own(step.effect->name());
    double held = 0.0;
    for (const auto& set : sets) {
      if (std::find(set.effects.begin(), set.effects.end(), own) != set.effects.end())
        held += set.probability;
    }
    out.among_names.push_back(std::min(1.0, held));
    out.of_steps.push_back((1.0 - kFeigned * out.outside) * out.among_names.back());
  }
  double held = 0.0;
  for (const auto& set : sets) {
    if (held >= 1.0 - kTied) break;
    held += set.probability;
    out.alternatives.push_back(set);
  }
  return out;
}

}  // namespace bodesmith::gap
