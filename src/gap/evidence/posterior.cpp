#include "gap/evidence/posterior.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "gap/evidence/score.hpp"

namespace bodesmith::gap {
namespace {

// The odds that the names told are not the answer are k times what they leave of the held-out records' gap (bench/calibration.py, 498 names told of
// 472 drawn cases of two generators, one in thirteen of them with something outside the catalogue).
/// k where the verdict is that nothing is left: 7 of 387 names were wrong, 6 of the 52 that leave a fifth to a half.
constexpr double kOddsOfAWhole = 0.1;
/// Times the square of how plain the plainest sign is: right were 18 of 19 names alongside a sign of less than 1.5 times what chance
/// reaches, 5 of 10 of less than 2, 4 of 56 of more than 3. Without a sign, where held-out records or a floor contradict what was found, k
/// is 1: of 16 names 12 were right, 6 of the 6 that leave less than a fifth.
constexpr double kOddsOfASign = 3.0;
/// As sure as it ever is, and with nothing found and nothing left: none of 80 such verdicts, none of the 230 names that leave least was wrong.
constexpr double kLeastOutside = 0.01;

double odds_of_outside(const SearchResult& result, bool more_is_left) {
  if (!more_is_left) return kOddsOfAWhole;
  double plainest = 0.0;
  for (const Sign& sign : result.structure) plainest = std::max(plainest, sign.strength);
  return plainest > 0.0 ? kOddsOfASign * plainest * plainest : 1.0;
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

Posterior posterior_of(const SearchResult& result, bool more_is_left, double share_left) {
  Posterior out;
  const double odds = share_left * odds_of_outside(result, more_is_left);
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
