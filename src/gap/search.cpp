#include "gap/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "gap/scene.hpp"
#include "gap/shortlist.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Long records are first fitted on a stretch of this many samples.
constexpr std::size_t kStretch = 8000;

/// Held-out gain that a term must earn when one of its few unknowns rests at a bound.
constexpr double kGainAtBound = 0.05;

/// Held-out rms within which a rival with up to two unknowns more counts as a tie.
constexpr double kNearlyEqual = 0.02;

/// Unknowns that do not rest at a bound: weights of 0 cost nothing.
std::size_t effective_of(const Term& term) {
  const auto inside = std::count_if(term.unknowns.begin(), term.unknowns.end(),
                                    [](const Unknown& u) { return u.value > u.low && u.value < u.high; });
  return std::max<std::size_t>(1, static_cast<std::size_t>(inside));
}

double range_of(const Experiments& records) {
  double range = 0.0;
  for (const auto* e : records) range = std::max(range, e->range());
  return range;
}

/// Iterations that each start of a candidate gets before the best ones go on, and what is near to the best.
constexpr int kFirstSteps = 6;
constexpr double kWorthGoingOn = 1.15;
/// Effects shortlisted in the first round besides, as seen from the given parameters.
constexpr std::size_t kSeenFromGiven = 3;
/// A rival is tried in an earlier term's place when it was not this much worse in that term's own round.
constexpr double kFarWorse = 2.5;

class Search {
 public:
  Search(const chain::Chain& base, const Experiments& train, const Experiments& holdout,
         const SearchOptions& options)
      : options_(options), initial_(base), model_(base) {
    train_ = own(train);
    holdout_ = own(holdout);
    make_stretches();
  }

  SearchResult run();

 private:
  bool stopped() const { return options_.stop && options_.stop(); }
  void report(double fraction) const {
    if (options_.progress) options_.progress(fraction);
  }
  Experiments own(const Experiments& given);
  bool drop_wrong_starts(const Model& model);
  bool stands_out_at_start(const Model& model, const TimeExperiment& record) const;
  void leave_out_starts(const Model& model);
  bool score_starts_again(Model& model);
  void make_stretches();
  LeastSquaresOptions fit_options(int iterations) const {
    LeastSquaresOptions o;
    o.iterations = iterations;
    o.stop = options_.stop;
    return o;
  }
  /// Fits on a stretch first when the records are long.
  LeastSquaresResult fit_all(Model& model, int iterations) const;
  std::vector<std::vector<double>> base_starts() const;
  void refit_base();
  void settle_open_parameters();
  void settle(Model& model) const;
  NoiseFloor floor_of(const Model& model) const;
  bool at_floor(const Model& model) const;

  std::vector<Promising> look_from(const Model& model, const std::set<std::string_view>* only) const;
  std::vector<Ranked> round(const Model& model, const std::set<std::string_view>* only);
  Ranked fit_candidate(const Promising& p, const std::vector<double>& before_train,
                       const std::vector<double>& before_holdout) const;
  void judge(Ranked& r, const std::vector<double>& before_train,
             const std::vector<double>& before_holdout) const;
  bool earns_its_place(Ranked& r, double before_holdout) const;
  double control_gain(const Model& before, const Ranked& winner) const;
  std::optional<Step> choose(const Model& before, std::vector<Ranked>& ranking);
  std::optional<std::array<Step, 2>> choose_pair(const Model& before, const std::vector<Ranked>& ranking);
  /// What taking term k out again would cost; `without` becomes the refitted model that lacks it.
  struct Worth {
    double gain = 0.0;  ///< held-out, share of rms
    double z = 0.0;
    double train_z = 0.0;
  };
  Worth worth_of(const Model& with, std::size_t k, Model& without) const;
  bool something_left(const Model& model) const;
  bool prune(std::vector<Step>& steps);
  bool swap_earlier(std::vector<Step>& steps);
  std::vector<Leftover> leftovers(const Model& model, const Experiments& records) const;

  SearchOptions options_;
  std::vector<std::unique_ptr<TimeExperiment>> owned_;
  std::map<const Experiment*, std::size_t> start_;  ///< samples of each record's start, see drop_wrong_starts
  std::set<const Experiment*> dropped_;             ///< began in another state than rest
  Experiments train_;
  Experiments holdout_;
  std::vector<std::unique_ptr<Experiment>> stretches_;
  Experiments look_;
  Model initial_;
  Model model_;
  std::vector<std::string> notes_;
  bool long_records_ = false;
};

/// Copies in which the start is scored at first.
Experiments Search::own(const Experiments& given) {
  Experiments mine;
  for (const auto* e : given) {
    const auto* time = dynamic_cast<const TimeExperiment*>(e);
    if (time == nullptr) {
      mine.push_back(e);
      continue;
    }
    owned_.push_back(std::make_unique<TimeExperiment>(*time));
    start_[owned_.back().get()] = time->start_may_be_scored() ? time->skip() : 0;
    if (time->start_may_be_scored()) owned_.back()->set_skip(0);
    mine.push_back(owned_.back().get());
  }
  return mine;
}

/// Whether the residual of a whole record is plainly larger at its start than in the rest.
bool Search::stands_out_at_start(const Model& model, const TimeExperiment& record) const {
  constexpr double kStandsOut = 1.35;
  const std::size_t start = start_.at(&record);
  TimeExperiment whole(record);
  whole.set_skip(0);
  whole.set_free_start({});
  const auto residual = residuals_of(model, {&whole});
  if (residual.size() <= start) return false;
  const auto part = [&](std::size_t from, std::size_t to) {
    return rms({residual.begin() + static_cast<std::ptrdiff_t>(from),
                residual.begin() + static_cast<std::ptrdiff_t>(to)});
  };
  const double rest = part(start, residual.size());
  for (std::size_t length : {start / 4, start / 2, start}) {
    if (length >= 12 && part(0, length) > kStandsOut * rest) return true;
  }
  return false;
}

/// A record should begin at rest, and its start then tells much (how a resonance rings up). When it began
/// otherwise, the residual stands out there, whatever else is missing: that start is no longer scored, or,
/// when it would take too much of the record, what unknown initial states explain is taken out.
bool Search::drop_wrong_starts(const Model& model) {
  bool changed = false;
  for (const auto& e : owned_) {
    if (dropped_.count(e.get()) != 0 || start_[e.get()] == 0 || !stands_out_at_start(model, *e)) continue;
    dropped_.insert(e.get());
    changed = true;
  }
  if (changed) leave_out_starts(model);
  return changed;
}

/// The records whose starts do not count, with free responses as the model has them now.
void Search::leave_out_starts(const Model& model) {
  for (const auto& e : owned_) {
    if (dropped_.count(e.get()) == 0) continue;
    const std::size_t start = start_[e.get()];
    const bool long_start = 4 * start >= e->to();
    e->set_skip(long_start ? e->to() * 3 / 100 : start);
    e->set_free_start(long_start ? free_responses(model, *e, e->skip()) : std::vector<std::vector<double>>{});
  }
}

/// What stood out at a start may have been the missing effect itself. With a better model the starts are
/// tried again: those that now fit as well as the rest are scored.
bool Search::score_starts_again(Model& model) {
  if (dropped_.empty()) return false;
  const double before = rms_of(model, holdout_);
  const auto dropped_before = dropped_;
  for (const auto& e : owned_) {
    if (dropped_.count(e.get()) == 0) continue;
    e->set_skip(0);
    e->set_free_start({});
  }
  Model refitted = model;
  fit_all(refitted, 20);
  for (const auto& e : owned_) {
    if (dropped_.count(e.get()) != 0 && !stands_out_at_start(refitted, *e)) dropped_.erase(e.get());
  }
  leave_out_starts(refitted);
  const auto dropped_after = dropped_;
  bool better = dropped_after.size() < dropped_before.size();
  if (better) {
    fit_all(refitted, 8);
    // The rest of the records must not pay for it.
    dropped_ = dropped_before;
    leave_out_starts(model);
    better = rms_of(refitted, holdout_) < 1.03 * before;
  }
  dropped_ = better ? dropped_after : dropped_before;
  if (better) model = refitted;
  for (const auto& e : owned_) {
    if (dropped_.count(e.get()) != 0 || dropped_before.count(e.get()) == 0) continue;
    e->set_skip(0);
    e->set_free_start({});
  }
  leave_out_starts(model);
  return better;
}

void Search::make_stretches() {
  std::size_t total = 0;
  for (const auto* e : train_) total += e->scored();
  long_records_ = total > 3 * kStretch / 2 * 1;
  for (const auto* e : train_) {
    const auto* time = dynamic_cast<const TimeExperiment*>(e);
    if (time == nullptr || !long_records_) {
      look_.push_back(e);
      continue;
    }
    const std::size_t lead = std::max<std::size_t>(start_.at(time), 200);
    const std::size_t samples = std::max<std::size_t>(1500, kStretch / train_.size());
    TimeRecord cut = time->record();
    cut.u.resize(time->to());
    cut.y.resize(time->to());
    cut = lively_stretch(cut, lead, samples);
    auto shorter = std::make_unique<TimeExperiment>(std::move(cut));
    shorter->set_skip(lead);
    shorter->set_coarse();
    look_.push_back(shorter.get());
    stretches_.push_back(std::move(shorter));
  }
}

LeastSquaresResult Search::fit_all(Model& model, int iterations) const {
  if (!long_records_) return fit(model, train_, fit_options(iterations));
  fit(model, look_, fit_options(iterations));
  return fit(model, train_, fit_options(std::min(iterations, 4)));
}

/// Parameters that are off make the sum of squares hilly (a resonance beside its peak): frequencies are first
/// tried over a comb, each alone and all together, the output's size left free, and the best few are fitted.
std::vector<std::vector<double>> Search::base_starts() const {
  const auto unknowns = initial_.unknowns();
  const auto given = current_values(initial_);
  std::vector<std::size_t> tuned;
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    if (unknowns[k].name.find("_hz") != std::string::npos) tuned.push_back(k);
  }
  std::vector<std::vector<double>> starts = {given};
  if (tuned.empty()) return starts;
  Runner runner(initial_, look_);
  std::vector<double> measured;
  for (const auto* e : look_) {
    const auto* time = dynamic_cast<const TimeExperiment*>(e);
    if (time == nullptr) return starts;
    measured.insert(measured.end(), time->record().y.begin() + static_cast<std::ptrdiff_t>(time->skip()),
                    time->record().y.begin() + static_cast<std::ptrdiff_t>(time->to()));
  }
  std::vector<double> e;
  std::vector<std::pair<double, std::vector<double>>> scored;
  const auto look = [&](const std::vector<double>& values) {
    if (!runner(values, e)) return;
    double ym = 0.0;
    double yy = 0.0;
    double mm = 0.0;
    for (std::size_t i = 0; i < e.size(); ++i) {
      const double y = e[i] + measured[i];
      ym += y * measured[i];
      yy += y * y;
      mm += measured[i] * measured[i];
    }
    scored.emplace_back(yy > 0.0 ? mm - ym * ym / yy : mm, values);
  };
  std::vector<double> factors;
  for (double f = -0.42; f < 0.43; f += 0.06) factors.push_back(std::exp(f));
  for (double f : factors) {
    auto values = given;
    for (std::size_t k : tuned) values[k] = std::clamp(given[k] * f, unknowns[k].low, unknowns[k].high);
    look(values);
    if (tuned.size() < 2) continue;
    for (std::size_t k : tuned) {
      values = given;
      values[k] = std::clamp(given[k] * f, unknowns[k].low, unknowns[k].high);
      look(values);
    }
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [size, values] : scored) {
    // Neighbours on the comb lead to the same place.
    const bool near = std::any_of(starts.begin() + 1, starts.end(), [&](const auto& s) {
      double apart = 0.0;
      for (std::size_t k : tuned) apart = std::max(apart, std::abs(std::log(s[k] / values[k])));
      return apart < 0.09;
    });
    if (!near) starts.push_back(values);
    if (starts.size() >= 4) break;
  }
  return starts;
}

void Search::refit_base() {
  double least = 1e300;
  Model best = initial_;
  for (const auto& start : base_starts()) {
    if (stopped() && least < 1e299) break;
    Model m = initial_;
    m.set_values(start);
    if (!fit_all(m, 40).usable) continue;
    const double reached = rms_of(m, train_);
    // The given values' own neighbourhood is preferred to another hill as good.
    if (reached < 0.98 * least) {
      least = reached;
      best = m;
    }
  }
  model_ = best;
}

/// The model as good as its own freedom makes it, so that no term is credited with what a refit alone gains.
void Search::settle(Model& model) const {
  double least = rms_of(model, train_);
  const auto given = initial_.unknowns();
  Model best = model;
  for (const bool from_given : {false, true}) {
    if (from_given && given.empty()) break;
    Model m = model;
    if (from_given) {
      auto values = current_values(m);
      for (std::size_t k = 0; k < given.size(); ++k) values[k] = given[k].value;
      m.set_values(values);
    }
    if (!fit_all(m, 12).usable) continue;
    const double reached = rms_of(m, train_);
    if (reached < 0.9999 * least) {
      least = reached;
      best = m;
    }
  }
  model = best;
}

/// Training records may leave the free parameters open (one sine cannot tell gain, frequency and damping of a
/// resonator apart). When values exist that serve the held-out records far better at no cost to the training
/// records, it was the parameters, not the model: those are taken, and said.
void Search::settle_open_parameters() {
  constexpr double kFarBetter = 0.9;
  constexpr double kNoCost = 1.01;
  if (initial_.unknowns().empty()) return;
  const double train = rms_of(model_, train_);
  const double holdout = rms_of(model_, holdout_);
  if (holdout < 1.2 * train && holdout < 0.01 * range_of(holdout_)) return;
  Experiments both = train_;
  both.insert(both.end(), holdout_.begin(), holdout_.end());
  Model best = model_;
  double least = holdout;
  for (const auto& start : base_starts()) {
    if (stopped()) return;
    Model m = initial_;
    m.set_values(start);
    if (!fit(m, both, fit_options(25)).usable) continue;
    leave_out_starts(m);
    fit(m, both, fit_options(12));
    const double reached = rms_of(m, holdout_);
    if (reached < least && rms_of(m, train_) < kNoCost * train) {
      least = reached;
      best = m;
    }
  }
  if (least < kFarBetter * holdout) {
    model_ = best;
    notes_.push_back(
        "The training records leave free parameters of the model open; they were fitted to the held-out "
        "records "
        "as well");
  }
  leave_out_starts(model_);
}

NoiseFloor Search::floor_of(const Model& model) const {
  for (const auto* e : train_) {
    const auto* time = dynamic_cast<const TimeExperiment*>(e);
    if (time == nullptr) continue;
    Runner runner(model, {time});
    const auto outputs = runner.outputs(current_values(model));
    if (outputs.empty()) continue;
    std::vector<double> residual(time->to());
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = time->record().y[i] - outputs[0][i];
    const std::vector<double> input(time->record().u.begin(),
                                    time->record().u.begin() + static_cast<std::ptrdiff_t>(time->to()));
    const auto floor = noise_floor(residual, input, start_.at(time), time->record().step_s);
    if (floor.how != NoiseFloor::How::unknown) return floor;
  }
  return {};
}

bool Search::at_floor(const Model& model) const {
  const auto floor = floor_of(model);
  if (floor.how != NoiseFloor::How::periods || floor.periods < 2) return false;
  // The floor belongs to the periodic record: compare there, and on held-out data as well, which may go
  // further.
  for (const auto* e : train_) {
    const auto* time = dynamic_cast<const TimeExperiment*>(e);
    if (time == nullptr) continue;
    if (rms_of(model, {time}) > options_.enough * floor.rms) return false;
  }
  if (rms_of(model, holdout_) > options_.enough * floor.rms) return false;
  // What does not repeat may be more than noise (a gain that drifts away).
  return signs_of_structure(leftovers(model, train_), leftovers(model, holdout_)).empty();
}

std::vector<Leftover> Search::leftovers(const Model& model, const Experiments& records) const {
  std::vector<Leftover> all;
  for (const auto* e : records) {
    const auto* time = dynamic_cast<const TimeExperiment*>(e);
    if (time == nullptr) {
      Leftover l;
      l.response = residuals_of(model, {e});
      all.push_back(std::move(l));
      continue;
    }
    Runner runner(model, {e});
    const auto outputs = runner.outputs(current_values(model));
    if (outputs.empty()) continue;
    Leftover l;
    l.step_s = time->record().step_s;
    for (std::size_t i = time->skip(); i < time->to(); ++i) {
      l.residual.push_back(time->record().y[i] - outputs[0][i]);
      l.input.push_back(time->record().u[i]);
      l.output.push_back(outputs[0][i]);
    }
    time->take_out_free_start(l.residual);
    all.push_back(std::move(l));
  }
  return all;
}

Ranked Search::fit_candidate(const Promising& p, const std::vector<double>& before_train,
                             const std::vector<double>& before_holdout) const {
  Ranked r;
  const auto& term = p.proposal.model.terms().back();
  r.effect = term.effect;
  r.placed = term.placed;
  r.score = p.score;
  r.unknowns = term.unknowns.size();
  double least = 1e300;
  const std::size_t tries = std::min<std::size_t>(p.best_starts.size(), p.proposal.starts.size() > 4 ? 3 : 2);
  const int most = r.unknowns > 8 ? 14 : 30;
  // Earlier terms, and the free parameters, may have taken over what the new one explains better: one more
  // try begins with the last of them weak, one with the parameters as they were given.
  const auto given = initial_.unknowns();
  const std::size_t earlier = p.proposal.model.terms().size() - 1;
  struct Try {
    Model model;
    double rms = 1e300;
  };
  std::vector<Try> begun;
  for (std::size_t t = 0; t < tries + 2; ++t) {
    if (stopped() && !begun.empty()) break;
    Model m = p.proposal.model;
    auto values = current_values(m);
    const auto& start = p.proposal.starts[p.best_starts[t < tries ? t : 0]];
    if (t == tries + 1) {
      if (given.empty()) break;
      for (std::size_t k = 0; k < given.size(); ++k) values[k] = given[k].value;
    }
    if (t == tries) {
      if (earlier == 0) continue;
      std::size_t at = m.free_count();
      for (std::size_t k = 0; k + 1 < earlier; ++k) at += m.terms()[k].unknowns.size();
      const auto& u = m.terms()[earlier - 1].unknowns.front();
      if (!u.logarithmic) continue;
      const bool large_is_weak = u.name.ends_with("_hz") || u.name.ends_with("rate_per_s");
      values[at] = std::clamp(values[at] * (large_is_weak ? 8.0 : 0.125), u.low, u.high);
    }
    std::copy(start.begin(), start.end(), values.end() - static_cast<std::ptrdiff_t>(start.size()));
    m.set_values(values);
    auto options = fit_options(kFirstSteps);
    options.cost_tolerance = 1e-4;
    const auto result = fit(m, look_, options);
    if (result.usable) begun.push_back({std::move(m), result.rms});
  }
  // A few steps from everywhere, then on from where they led furthest.
  std::stable_sort(begun.begin(), begun.end(), [](const Try& x, const Try& y) { return x.rms < y.rms; });
  for (std::size_t t = 0; t < std::min<std::size_t>(begun.size(), 2); ++t) {
    if (t > 0 && (begun[t].rms > kWorthGoingOn * begun[0].rms || stopped())) break;
    auto options = fit_options(most);
    options.cost_tolerance = 1e-6;
    auto& m = begun[t].model;
    const auto result = fit(m, look_, options);
    if (!result.usable || !(result.rms < least)) continue;
    least = result.rms;
    r.model = m;
    r.condition_number = result.condition_number;
    r.deviation.assign(result.deviation.end() - static_cast<std::ptrdiff_t>(r.unknowns),
                       result.deviation.end());
  }
  r.train_rms = r.holdout_rms = 1e300;
  if (least > 1e299) return r;
  judge(r, before_train, before_holdout);
  return r;
}

void Search::judge(Ranked& r, const std::vector<double>& before_train,
                   const std::vector<double>& before_holdout) const {
  const auto e = residuals_of(r.model, train_);
  const auto f = residuals_of(r.model, holdout_);
  if (e.size() != before_train.size() || f.size() != before_holdout.size()) return;
  r.effective = effective_of(r.model.terms().back());
  r.train_rms = rms(e);
  r.holdout_rms = rms(f);
  r.train_z = improvement_z(before_train, e);
  r.z = improvement_z(before_holdout, f);
}

/// What every effect promises when the search stands at this model, best first.
std::vector<Promising> Search::look_from(const Model& model, const std::set<std::string_view>* only) const {
  const auto scene = make_scene(model, train_);
  std::vector<Proposal> proposals;
  for (const auto* effect : effects()) {
    if (scene.frequency_only && !effect->linear()) continue;
    if (only != nullptr && only->count(effect->name()) == 0) continue;
    effect->propose(scene, proposals);
  }
  // Twice the same is one term with more freedom than it says.
  std::erase_if(proposals, [](const Proposal& p) {
    const auto& terms = p.model.terms();
    return terms.back().effect->name() != "mains_hum" &&
           std::any_of(terms.begin(), terms.end() - 1,
                       [&](const Term& t) { return t.effect == terms.back().effect; });
  });
  return shortlist(model, std::move(proposals), look_, options_.threads);
}

std::vector<Ranked> Search::round(const Model& model, const std::set<std::string_view>* only) {
  std::vector<Ranked> ranking;
  // The best two places of each effect, one more when it is of another form, and the best effects.
  std::map<const Effect*, int> places;
  std::map<const Effect*, std::set<std::size_t>> forms;
  std::vector<Promising> chosen;
  std::set<const Effect*> kinds;
  const auto choose_from = [&](std::vector<Promising> promising, std::size_t most_kinds,
                               const std::set<const Effect*>& already) {
    for (auto& p : promising) {
      const auto* effect = p.proposal.model.terms().back().effect;
      if (p.score < 0.003 || already.count(effect) != 0) continue;
      const std::size_t form = p.proposal.model.terms().back().unknowns.size();
      const bool new_form = forms[effect].count(form) == 0;
      if (places[effect] >= (new_form ? 3 : 2)) continue;
      if (kinds.count(effect) == 0 && kinds.size() >= most_kinds) continue;
      kinds.insert(effect);
      ++places[effect];
      forms[effect].insert(form);
      chosen.push_back(std::move(p));
    }
  };
  const auto most = static_cast<std::size_t>(options_.shortlist);
  choose_from(look_from(model, only), most, {});
  if (stopped()) return ranking;
  if (model.terms().empty() && model.free_count() > 0 && !long_records_) {
    // Free parameters that took over a missing effect's share hide it: a few more, as they look from the
    // parameters that were given.
    auto already = kinds;
    for (const auto* effect : kinds) {
      if (!effect->starts_from_residual()) continue;
      already.erase(effect);
      places[effect] = 0;
    }
    choose_from(look_from(initial_, only), most + kSeenFromGiven, already);
    if (stopped()) return ranking;
  }
  const auto before_train = residuals_of(model, train_);
  const auto before_holdout = residuals_of(model, holdout_);
  ranking.resize(chosen.size());
  parallel_for(chosen.size(), options_.threads,
               [&](std::size_t i) { ranking[i] = fit_candidate(chosen[i], before_train, before_holdout); });
  std::erase_if(ranking, [](const Ranked& r) { return r.holdout_rms > 1e299; });
  if (long_records_) {
    // Only what leads after the fit on a stretch is worth fitting on all of the record.
    std::stable_sort(ranking.begin(), ranking.end(),
                     [](const Ranked& a, const Ranked& b) { return a.holdout_rms < b.holdout_rms; });
    parallel_for(std::min<std::size_t>(4, ranking.size()), options_.threads, [&](std::size_t i) {
      if (stopped()) return;
      auto& r = ranking[i];
      Ranked better = r;
      const auto result = fit(better.model, train_, fit_options(4));
      if (!result.usable) return;
      better.condition_number = result.condition_number;
      better.deviation.assign(result.deviation.end() - static_cast<std::ptrdiff_t>(r.unknowns),
                              result.deviation.end());
      judge(better, before_train, before_holdout);
      r = std::move(better);
    });
  }
  return ranking;
}

bool Search::earns_its_place(Ranked& r, double before_holdout) const {
  const double gain = 1.0 - r.holdout_rms / before_holdout;
  if (!(gain >= options_.least_gain)) {
    r.word = "no held-out gain";
    return false;
  }
  const double both = (r.z + std::min(r.train_z, 2.0 * r.z)) / std::sqrt(2.0);
  if (r.z < options_.least_significance || r.train_z < options_.least_significance ||
      both < options_.least_combined) {
    r.word = "not significant";
    return false;
  }
  if (r.unknowns > options_.most_unknowns) {
    r.word = "too free without another excitation held out";
    return false;
  }
  if (r.condition_number > options_.largest_condition) {
    r.word = "ill-conditioned";
    return false;
  }
  // A shape that only fits at the end of its range is another's.
  const auto& unknowns = r.model.terms().back().unknowns;
  const bool at_bound = unknowns.size() < 4 &&
                        std::any_of(unknowns.begin(), unknowns.end(),
                                    [](const Unknown& u) { return u.value <= u.low || u.value >= u.high; });
  if (at_bound && gain < kGainAtBound) {
    r.word = "at the end of its range";
    return false;
  }
  return true;
}

double Search::control_gain(const Model& before, const Ranked& winner) const {
  // The same term on records that cannot hold it: the model's own output plus noise of the residual's
  // spectrum.
  double most = 0.0;
  for (std::uint64_t k = 0; k < 2; ++k) {
    std::vector<std::unique_ptr<TimeExperiment>> owned;
    Experiments fake_train;
    Experiments fake_holdout;
    for (const auto* records : {&train_, &holdout_}) {
      for (const auto* e : *records) {
        const auto* time = dynamic_cast<const TimeExperiment*>(e);
        if (time == nullptr) return 0.0;
        Runner runner(before, {e});
        const auto outputs = runner.outputs(current_values(before));
        if (outputs.empty()) return 0.0;
        TimeRecord record = time->record();
        std::vector<double> residual;
        // What the term leaves, so that what it took away (a line of the mains) does not stand in the noise.
        const auto after = Runner(winner.model, {e}).outputs(current_values(winner.model));
        if (after.empty()) return 0.0;
        for (std::size_t i = time->skip(); i < time->to(); ++i) residual.push_back(record.y[i] - after[0][i]);
        time->take_out_free_start(residual);
        const auto noise = phase_surrogate(residual, options_.seed * 77 + 13 * k + owned.size());
        for (std::size_t i = 0; i < record.size(); ++i) {
          record.y[i] =
              outputs[0][i] + noise[(i + noise.size() - time->skip() % noise.size()) % noise.size()];
        }
        owned.push_back(std::make_unique<TimeExperiment>(std::move(record)));
        owned.back()->set_to(time->to());
        owned.back()->set_skip(time->skip());
        owned.back()->set_free_start(time->free_start());
        (records == &train_ ? fake_train : fake_holdout).push_back(owned.back().get());
      }
    }
    Model model = winner.model;
    Model plain = before;
    fit(plain, fake_train, fit_options(4));
    const auto result = fit(model, fake_train, fit_options(6));
    if (!result.usable) continue;
    // `before` is the truth of these records: a refit of it that got worse is no gain of the term's.
    const double without = std::min(rms_of(plain, fake_holdout), rms_of(before, fake_holdout));
    most = std::max(most, 1.0 - rms_of(model, fake_holdout) / without);
  }
  return most;
}

/// Pooled size of what a candidate leaves, both records counted alike.
double pooled(const Ranked& r, double train0, double holdout0) {
  return std::sqrt(0.5 * (r.train_rms * r.train_rms / (train0 * train0) +
                          r.holdout_rms * r.holdout_rms / (holdout0 * holdout0)));
}

std::optional<Step> Search::choose(const Model& before, std::vector<Ranked>& ranking) {
  const double train0 = rms_of(before, train_);
  const double holdout0 = rms_of(before, holdout_);
  const auto size = [&](const Ranked& r) { return pooled(r, train0, holdout0); };
  std::stable_sort(ranking.begin(), ranking.end(),
                   [&](const Ranked& a, const Ranked& b) { return size(a) < size(b); });
  std::vector<Ranked*> good;
  for (auto& r : ranking) {
    if (earns_its_place(r, holdout0)) good.push_back(&r);
  }
  while (!good.empty()) {
    Ranked* winner = good.front();
    // Fewer unknowns win when more of them buy next to nothing.
    for (auto* r : good) {
      if (r->effective >= winner->effective) continue;
      const double worse = size(*r) / size(*good.front()) - 1.0;
      if (worse < 0.01 + 0.004 * static_cast<double>(good.front()->effective - r->effective)) winner = r;
    }
    const double control = control_gain(before, *winner);
    const double gain = 1.0 - winner->holdout_rms / holdout0;
    if (gain < options_.control_factor * control) {
      winner->word = "no more than a control";
      good.erase(std::find(good.begin(), good.end(), winner));
      continue;
    }
    Step step;
    step.effect = winner->effect;
    step.placed = winner->placed;
    step.before = before;
    step.after = winner->model;
    step.control_gain = control;
    winner->word = "named";
    for (auto* r : good) {
      if (r == winner) continue;
      const double worse = r->holdout_rms / winner->holdout_rms - 1.0;
      if (r->effect == winner->effect) {
        r->word = "other place or form";
        if (worse < options_.tie_within && r->placed != winner->placed &&
            std::find(step.also_placed.begin(), step.also_placed.end(), r->placed) ==
                step.also_placed.end()) {
          step.also_placed.push_back(r->placed);
        }
        continue;
      }
      const std::string name(r->effect->name());
      // A rival with a little more freedom is as good a name when it is at least as near.
      const bool as_free =
          r->unknowns <= winner->unknowns || (r->unknowns <= winner->unknowns + 2 && worse < kNearlyEqual);
      if (worse >= options_.tie_within) {
        r->word = "worse";
      } else if (!as_free) {
        r->word = "also fits, with more unknowns";
        if (std::find(step.also_fit.begin(), step.also_fit.end(), name) == step.also_fit.end())
          step.also_fit.push_back(name);
      } else {
        r->word = "tied";
        if (std::find(step.tied_with.begin(), step.tied_with.end(), name) == step.tied_with.end())
          step.tied_with.push_back(name);
      }
    }
    std::stable_sort(ranking.begin(), ranking.end(),
                     [](const Ranked& a, const Ranked& b) { return a.holdout_rms < b.holdout_rms; });
    step.ranking = ranking;
    return step;
  }
  return std::nullopt;
}

Search::Worth Search::worth_of(const Model& with, std::size_t k, Model& without) const {
  without = with;
  without.remove(k);
  fit_all(without, 12);
  const auto holdout_with = residuals_of(with, holdout_);
  const auto holdout_without = residuals_of(without, holdout_);
  Worth worth;
  if (holdout_without.empty()) return {1.0, 1e9, 1e9};
  worth.gain = 1.0 - rms(holdout_with) / std::max(rms(holdout_without), 1e-300);
  worth.z = improvement_z(holdout_without, holdout_with);
  worth.train_z = improvement_z(residuals_of(without, train_), residuals_of(with, train_));
  return worth;
}

bool Search::something_left(const Model& model) const {
  const auto floor = floor_of(model);
  if (floor.how == NoiseFloor::How::periods && rms_of(model, holdout_) > 1.5 * floor.rms) return true;
  return !signs_of_structure(leftovers(model, train_), leftovers(model, holdout_)).empty();
}

/// Two effects can hide each other: neither earns its place while the other one's share stands as noise. When
/// nothing does alone and yet something is left, the most promising ones are put in on trial; they stay when
/// a second one then earns its place and they earn theirs beside it.
std::optional<std::array<Step, 2>> Search::choose_pair(const Model& before,
                                                       const std::vector<Ranked>& ranking) {
  const double train0 = rms_of(before, train_);
  const double holdout0 = rms_of(before, holdout_);
  std::vector<const Ranked*> trials;
  for (const auto& r : ranking) {
    if (r.condition_number > options_.largest_condition || r.unknowns > options_.most_unknowns) continue;
    if (pooled(r, train0, holdout0) < 0.98 && r.train_rms < 0.99 * train0) trials.push_back(&r);
  }
  std::stable_sort(trials.begin(), trials.end(), [&](const Ranked* a, const Ranked* b) {
    return pooled(*a, train0, holdout0) < pooled(*b, train0, holdout0);
  });
  std::set<const Effect*> tried;
  for (const auto* first : trials) {
    if (stopped() || tried.size() >= 3) break;
    if (!tried.insert(first->effect).second) continue;
    auto second_ranking = round(first->model, nullptr);
    auto second = stopped() ? std::nullopt : choose(first->model, second_ranking);
    if (!second) continue;
    Model without;
    const std::size_t k = first->model.terms().size() - 1;
    const auto worth = worth_of(second->after, k, without);
    const double both = (worth.z + std::min(worth.train_z, 2.0 * worth.z)) / std::sqrt(2.0);
    if (worth.gain < options_.least_gain || worth.z < options_.least_significance ||
        worth.train_z < options_.least_significance || both < options_.least_combined)
      continue;
    if (!(rms_of(second->after, holdout_) < (1.0 - 3.0 * options_.least_gain) * holdout0)) continue;
    Step step;
    step.effect = first->effect;
    step.placed = first->placed;
    step.before = before;
    step.after = first->model;
    step.ranking = ranking;
    notes_.push_back(fmt::format("{} and {} earn their places only together", first->effect->name(),
                                 second->effect->name()));
    return std::array<Step, 2>{std::move(step), std::move(*second)};
  }
  return std::nullopt;
}

bool Search::prune(std::vector<Step>& steps) {
  bool changed = false;
  for (std::size_t k = 0; k + 1 < steps.size() && k + 1 < model_.terms().size();) {
    Model without;
    const auto [gain, z, train_z] = worth_of(model_, k, without);
    if (gain < options_.least_gain || z < 2.0) {
      notes_.push_back(fmt::format("{} was taken out again: a later term explains what it did",
                                   model_.terms()[k].effect->name()));
      model_ = without;
      steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(k));
      changed = true;
    } else {
      model_.set_significance(k, z);
      ++k;
    }
  }
  return changed;
}

bool Search::swap_earlier(std::vector<Step>& steps) {
  // Would another effect do better in an earlier term's place, now that the later ones are there?
  bool changed = false;
  for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
    if (stopped()) break;
    std::set<std::string_view> rivals;
    for (const auto& name : steps[k].tied_with) rivals.insert(find_effect(name)->name());
    const double own = rms_of(steps[k].after, holdout_);
    for (const auto& r : steps[k].ranking) {
      if (r.effect != steps[k].effect && rivals.size() < 5 && r.holdout_rms < kFarWorse * own)
        rivals.insert(r.effect->name());
    }
    if (rivals.empty()) continue;
    Model without = model_;
    without.remove(k);
    fit_all(without, 12);
    auto ranking = round(without, &rivals);
    const double now = rms_of(model_, holdout_);
    const double now_train = rms_of(model_, train_);
    const Ranked* best = nullptr;
    for (const auto& r : ranking) {
      if (r.condition_number > options_.largest_condition || r.unknowns > options_.most_unknowns) continue;
      const bool better = r.holdout_rms < 0.97 * now && r.train_rms < 0.99 * now_train;
      const bool simpler = r.effective < effective_of(model_.terms()[k]) && r.holdout_rms < 1.01 * now &&
                           r.train_rms < 1.01 * now_train;
      if ((better || simpler) && (best == nullptr || r.holdout_rms < best->holdout_rms)) best = &r;
    }
    if (best == nullptr) continue;
    notes_.push_back(fmt::format("{} took the place of {} once the other terms were there",
                                 best->effect->name(), steps[k].effect->name()));
    Step step;
    step.effect = best->effect;
    step.placed = best->placed;
    step.before = without;
    step.after = best->model;
    step.ranking = ranking;
    model_ = best->model;
    // Terms keep the order of the steps: the new one is the last.
    steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(k));
    steps.push_back(std::move(step));
    changed = true;
    break;
  }
  return changed;
}

SearchResult Search::run() {
  SearchResult result;
  result.initial = initial_;
  report(0.02);
  refit_base();
  if (drop_wrong_starts(model_)) {
    // Free responses of a model that is off are of no use: first without the starts, then with them.
    for (const auto& e : owned_) {
      if (dropped_.count(e.get()) == 0) continue;
      e->set_skip(start_[e.get()]);
      e->set_free_start({});
    }
    refit_base();
    for (int again = 0; again < 3; ++again) {
      leave_out_starts(model_);
      fit_all(model_, 12);
    }
  }
  settle_open_parameters();
  result.base = model_;
  std::vector<Step> steps;
  const std::set<std::string_view> unrelated = {"drift", "mains_hum", "creep"};
  for (int k = 0; k < options_.most_terms && !stopped(); ++k) {
    report(0.05 + 0.9 * k / options_.most_terms);
    // At the floor only what does not repeat with the input can be missing.
    const bool quiet = at_floor(model_);
    auto ranking = round(model_, quiet ? &unrelated : nullptr);
    auto step = stopped() ? std::nullopt : choose(model_, ranking);
    const Model model_before = model_;
    const std::vector<Step> steps_before = steps;
    if (!step && !stopped() && !quiet && k + 1 < options_.most_terms && something_left(model_)) {
      if (auto pair = choose_pair(model_, ranking)) {
        steps.push_back(std::move((*pair)[0]));
        step = std::move((*pair)[1]);
        ++k;
      }
    }
    if (!step) {
      result.refused = std::move(ranking);
      break;
    }
    Model refitted = step->after;
    fit_all(refitted, 8);
    // A joint refit that costs held-out error has only come closer to the training records.
    if (rms_of(refitted, holdout_) <= rms_of(step->after, holdout_)) step->after = refitted;
    model_ = step->after;
    const auto ranking_of_step = step->ranking;
    steps.push_back(std::move(*step));
    if (steps.size() > 1) {
      bool changed = prune(steps);
      changed = swap_earlier(steps) || changed;
      if (changed) prune(steps);
    }
    if (drop_wrong_starts(model_)) fit_all(model_, 8);
    score_starts_again(model_);
    leave_out_starts(model_);
    settle(model_);
    // Whatever was taken out or put in another's place: a round must leave the held-out error smaller.
    if (!(rms_of(model_, holdout_) <= (1.0 - options_.least_gain) * rms_of(model_before, holdout_))) {
      model_ = model_before;
      steps = steps_before;
      result.refused = ranking_of_step;
      break;
    }
  }
  result.final = model_;
  result.stopped = stopped();
  result.steps = std::move(steps);
  result.floor = floor_of(model_);
  result.train_rms = rms_of(model_, train_);
  if (!result.stopped)
    result.structure = signs_of_structure(leftovers(model_, train_), leftovers(model_, holdout_));
  result.notes = notes_;
  report(1.0);
  return result;
}

}  // namespace

double rms_of(const Model& model, const Experiments& experiments) {
  const auto e = residuals_of(model, experiments);
  return e.empty() ? 1e300 : rms(e);
}

SearchResult search(const chain::Chain& base, const Experiments& train, const Experiments& holdout,
                    const SearchOptions& options) {
  return Search(base, train, holdout, options).run();
}

}  // namespace bodesmith::gap
