#include "gap/search/group.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "base/text.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search/acceptance.hpp"
#include "gap/search/backward_elimination.hpp"
#include "gap/search/mode_chain.hpp"
#include "gap/search/remaining.hpp"
#include "gap/search/round.hpp"
#include "gap/search/step.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Candidates beside each of which every other one is fitted.
constexpr std::size_t kFirsts = 12;
/// Groups that are looked at closely.
constexpr std::size_t kCloseLooks = 6;
/// A group must leave less than this of what the round's own step leaves, beyond so many standard deviations.
constexpr double kFarLess = 0.85;
constexpr double kBeyondChance = 5.0;
/// Promise (standard deviations) of a second term beside a first one that is not right yet.
constexpr double kLittlePromise = 1.0;
/// Iterations of a group's own fit.
constexpr int kGroupIterations = 40;

/// Terms put in together, and what they leave.
struct Trial {
  std::vector<Ranked> rounds;  ///< the candidates one by one; the last one's model holds all
  std::vector<std::vector<Ranked>> rankings;
  std::vector<double> folds;
  double folds_rms = 0.0;
  std::size_t effective = 0;

  const Model& model() const { return rounds.back().model; }
  bool is_far_fetched() const {
    return std::any_of(rounds.begin(), rounds.end(), [](const Ranked& r) { return r.far_fetched; });
  }
  std::multiset<std::string> names() const {
    std::multiset<std::string> all;
    for (const auto& r : rounds) all.insert(std::string(r.effect->name()));
    return all;
  }
};

/// What the trial leaves once its terms are fitted together; false: it cannot be run, or its last term is no name.
bool finish(const SearchSetting& setting, const SearchRecords& records, Folds kind, Trial& trial) {
  auto fitted = fit(trial.model(), records.train, fit_options(setting.options, kGroupIterations));
  if (!fitted.result.usable() || fitted.result.condition_number > setting.options.acceptance.max_condition)
    return false;
  trial.rounds.back().model = std::move(fitted.model);
  const auto scene = make_scene(trial.model(), records.train);
  if (trial.rounds.back().effect->is_no_name(trial.model(), trial.model().terms().back(), scene))
    return false;
  trial.folds = folded_residuals(trial.model(), records.train, kind);
  if (trial.folds.empty()) return false;
  trial.folds_rms = rms(trial.folds);
  trial.effective = 0;
  const auto& terms = trial.model().terms();
  for (std::size_t k = terms.size() - trial.rounds.size(); k < terms.size(); ++k)
    trial.effective += terms[k].effective_unknowns();
  return true;
}

/// The best candidate of every effect beside the first one.
void add_pairs(const SearchSetting& setting, const SearchRecords& records, Folds kind, const Ranked& first,
               const std::vector<Ranked>& ranking, std::vector<Trial>& trials) {
  SearchOptions open = setting.options;
  open.round.min_promise_later = kLittlePromise;
  const SearchSetting wide{open, setting.initial, setting.first_gap};
  const auto seconds = fit_round(wide, records, first.model, {}, 0.0).ranking;
  std::set<const Effect*> tried;
  for (const auto& second : seconds) {
    if (!tried.insert(second.effect).second) continue;
    Trial trial{{first, second}, {ranking, seconds}, {}, 0.0, 0};
    if (finish(setting, records, kind, trial)) trials.push_back(std::move(trial));
  }
}

/// Every term of the trial is needed beside the others.
bool earns_all_places(const SearchSetting& setting, const SearchRecords& records, const Trial& trial) {
  const auto& accepted = setting.options.acceptance;
  const std::size_t count = trial.model().terms().size();
  for (std::size_t k = count - trial.rounds.size(); k < count; ++k) {
    const auto own = without_term(setting, records, trial.model(), k).gain;
    if (own.share < 1.0 - kFarLess || own.z < accepted.min_significance) return false;
  }
  const auto& terms = trial.model().terms();
  return std::none_of(terms.end() - static_cast<std::ptrdiff_t>(trial.rounds.size()), terms.end(),
                      [](const Term& term) {
                        return std::any_of(term.unknowns.begin(), term.unknowns.end(),
                                           [](const Unknown& u) { return u.at_bound(); }) &&
                               term.unknowns.size() <= 3;
                      });
}

bool as_good_as(const AcceptanceOptions& options, const Trial& trial, const Trial& best) {
  return as_good_on_folds(options, {trial.folds_rms, trial.folds}, {best.folds_rms, best.folds},
                          options.tie_surely_within);
}

/// The candidate that a round has named; null: none.
const Ranked* named_in(const std::vector<Ranked>& ranking) {
  const auto found = std::find_if(ranking.begin(), ranking.end(),
                                  [](const Ranked& r) { return r.outcome == CandidateOutcome::named; });
  return found == ranking.end() ? nullptr : &*found;
}

/// A trial of names near at hand that does as well as a far-fetched single one, with no more unknowns (two lags beside
/// one with a zero in the right half-plane).
const Trial* nearer_than(const SearchSetting& setting, const SearchRecords& records, const Ranked& single,
                         const std::vector<Trial>& trials) {
  const auto& accepted = setting.options.acceptance;
  for (const auto& trial : trials) {
    if (trial.is_far_fetched() || trial.effective > single.effective ||
        trial.folds.size() != single.folds.size())
      continue;
    const bool as_good = as_good_on_folds(accepted, {trial.folds_rms, trial.folds},
                                          {single.folds_rms, single.folds}, accepted.at_hand_within);
    if (as_good && earns_all_places(setting, records, trial)) return &trial;
  }
  return nullptr;
}

/// In `a` and not in `b`.
std::vector<std::string> only_in(const std::multiset<std::string>& a, const std::multiset<std::string>& b) {
  std::vector<std::string> out;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out;
}

/// Groups that are as good: where they differ from the chosen one in one name, that is a tie of this step.
void add_ties(const AcceptanceOptions& options, const std::vector<Trial>& trials, const Trial& chosen,
              std::vector<Step>& steps, std::vector<std::string>& as_good) {
  for (const auto& trial : trials) {
    if (&trial == &chosen || trial.effective > chosen.effective || !as_good_as(options, trial, chosen))
      continue;
    if (trial.is_far_fetched() && !chosen.is_far_fetched()) continue;
    if (std::any_of(trial.rounds.begin(), trial.rounds.end(), [](const Ranked& r) { return r.no_name; }))
      continue;
    const auto there = only_in(trial.names(), chosen.names());
    const auto here = only_in(chosen.names(), trial.names());
    if (there.empty()) continue;
    if (there.size() > 1 || here.size() > 1) {
      as_good.push_back(join(there, " and "));
      continue;
    }
    const auto step = std::find_if(steps.begin(), steps.end(),
                                   [&](const Step& s) { return s.effect->name() == here.front(); });
    auto& tied = step->tied_with;
    if (std::find(tied.begin(), tied.end(), there.front()) == tied.end()) tied.push_back(there.front());
  }
}

Group group_of(const AcceptanceOptions& options, const Model& before, const std::vector<Trial>& trials,
               const Trial& chosen) {
  Group group;
  std::vector<std::string> names;
  for (const auto& r : chosen.rounds) names.emplace_back(r.effect->name());
  Model last = before;
  for (std::size_t k = 0; k < chosen.rounds.size(); ++k) {
    Step step = step_of(last, chosen.rounds[k], chosen.rankings[k], CandidateOutcome::named_in_pair);
    step.pair_with = names[k + 1 < names.size() ? k + 1 : k - 1];
    last = chosen.rounds[k].model;
    group.steps.push_back(std::move(step));
  }
  std::vector<std::string> as_good;
  add_ties(options, trials, chosen, group.steps, as_good);
  group.ranking = group.steps.back().ranking;
  group.note = join(names, " and ") + " were looked for together";
  if (!as_good.empty()) group.note += ", and " + as_good.front() + " would do as well";
  return group;
}

}  // namespace

std::optional<Group> choose_group(const SearchSetting& setting, const SearchRecords& records,
                                  const Model& before, const std::vector<Ranked>& ranking,
                                  const Step* single) {
  const auto& options = setting.options;
  const Model& now = single != nullptr ? single->after : before;
  const bool left = is_something_left(options, now, records);
  const Ranked* named = single != nullptr ? named_in(ranking) : nullptr;
  const bool far_fetched = named != nullptr && named->far_fetched && named->effective > 1;
  if (!left && !far_fetched) return std::nullopt;
  const auto residuals = round_residuals(now, records);
  std::vector<Trial> trials;
  std::set<std::pair<const Effect*, std::string>> tried;
  std::vector<Ranked> firsts = ranking;
  std::stable_sort(firsts.begin(), firsts.end(),
                   [](const Ranked& a, const Ranked& b) { return a.train_rms < b.train_rms; });
  for (const auto& first : firsts) {
    if (options.is_late() || tried.size() >= kFirsts) break;
    if (!tried.emplace(first.effect, first.placed).second) continue;
    add_pairs(setting, records, residuals.kind, first, ranking, trials);
  }
  for (auto& chain : mode_chains(setting, records, before)) {
    if (chain.size() == 1) {
      add_pairs(setting, records, residuals.kind, chain.front(), ranking, trials);
      continue;
    }
    Trial trial;
    for (auto& mode : chain) {
      trial.rankings.push_back({mode});
      trial.rounds.push_back(std::move(mode));
    }
    if (finish(setting, records, residuals.kind, trial)) trials.push_back(std::move(trial));
  }
  std::stable_sort(trials.begin(), trials.end(),
                   [](const Trial& a, const Trial& b) { return a.folds_rms < b.folds_rms; });
  if (!left) {
    const Trial* nearer = nearer_than(setting, records, *named, trials);
    if (nearer == nullptr) return std::nullopt;
    return group_of(options.acceptance, before, trials, *nearer);
  }
  const double enough = kFarLess * rms(residuals.folds);
  std::size_t looks = 0;
  for (const auto& trial : trials) {
    if (!(trial.folds_rms < enough) || looks++ >= kCloseLooks || options.is_late()) break;
    if (improvement_z(residuals.folds, trial.folds) < kBeyondChance) continue;
    // Fewer unknowns, where they do as well, or names that are nearer at hand.
    const Trial* chosen = &trial;
    for (const auto& other : trials) {
      const bool nearer =
          other.effective == chosen->effective && chosen->is_far_fetched() && !other.is_far_fetched();
      if ((other.effective < chosen->effective || nearer) && as_good_as(options.acceptance, other, trial))
        chosen = &other;
    }
    if (!earns_all_places(setting, records, *chosen)) continue;
    return group_of(options.acceptance, before, trials, *chosen);
  }
  return std::nullopt;
}

}  // namespace bodesmith::gap
