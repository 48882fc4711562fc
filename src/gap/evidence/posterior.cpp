#include "gap/evidence/posterior.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "gap/evidence/score.hpp"

namespace bodesmith::gap {
namespace {

// The odds that the names told are not the answer go with what they leave of the gap (bench/calibration.py, 454 names told of 426 drawn cases of
// two generators, one in fifteen of them with something outside the catalogue): k times the share of it that is left of the held-out records.
// How plain a sign is tells nothing more.
/// k where the verdict is that nothing is left: 3 of 355 names were wrong, 2 of the 52 that leave a fifth and more.
constexpr double kOddsOfAWhole = 0.1;
/// Where it is that more is left, by a sign or as held-out records or a floor contradict what was found: of 99 names 46 were right.
constexpr double kOddsOfAPart = 12.0;
/// As sure as it ever is, and with nothing found and nothing left: 1 of 78 such verdicts, 1 of the 303 surest names were wrong.
constexpr double kLeastOutside = 0.01;

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

Posterior posterior_of(const SearchResult& result, bool more_is_left, double share_left) {
  Posterior out;
  const double odds = share_left * (more_is_left ? kOddsOfAPart : kOddsOfAWhole);
  out.outside = std::max(kLeastOutside, 1.0 - 1.0 / (1.0 + odds));
  std::vector<std::map<std::string, double>> steps;
  for (const auto& step : result.steps) steps.push_back(names_of_step(step));
  const auto sets = sets_of(steps);
  for (const auto& step : result.steps) {
    const std::string own(step.effect->told());
    double held = 0.0;
    for (const auto& set : sets) {
      if (std::find(set.effects.begin(), set.effects.end(), own) != set.effects.end())
        held += set.probability;
    }
    out.among_names.push_back(std::min(1.0, held));
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
