#include "gap/report/size.hpp"

#include <algorithm>
#include <tuple>

#include "chain/model_file.hpp"
#include "gap/runner.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/period.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::gap {
namespace {

/// A start stands out under the final model when its residual is this much larger than the rest's.
constexpr double kStartStandsOut = 1.5;

/// The model as a record of its own sees it: lines of the mains as this record has them.
Model for_record(const Model& model, const Experiment& experiment) {
  return model.line_blocks().empty() ? model : with_lines_of(model, experiment);
}

/// Residual of one record from its first to its last sample, as `simulate` makes it.
std::vector<double> whole_residual(const Model& model, const TimeExperiment& experiment) {
  simulate::Options options;
  options.estimate_error = false;
  const auto& record = experiment.record();
  const auto result = simulate::simulate(model.chain(), record, options);
  std::vector<double> e(experiment.end());
  for (std::size_t i = 0; i < e.size(); ++i) e[i] = record.y[i] - result.y[i];
  return e;
}

std::vector<double> whole_residual(const Model& model, const FrequencyExperiment& experiment) {
  auto e = residuals_of(model, {experiment});
  for (double& x : e) x = -x;
  return e;
}

std::vector<double> whole_residual(const Model& model, const Experiment& experiment) {
  return std::visit([&](const auto& kind) { return whole_residual(model, kind); }, experiment);
}

std::vector<Cell> where_in(const TimeExperiment& experiment, const std::vector<double>& residual,
                           std::size_t from) {
  const auto& u = experiment.record().u;
  const auto later = std::span(u).subspan(from);
  return where(experiment.record(), residual, from, find_period({later.begin(), later.end()}));
}

std::vector<Cell> where_in(const FrequencyExperiment& experiment, const std::vector<double>& residual,
                           std::size_t) {
  return where(experiment.record(), residual);
}

}  // namespace

const std::vector<double>& GapMeter::residual(const Model& model, const Experiment& experiment) const {
  Key key = {chain::model_text(model.chain()), &experiment};
  const auto known = residuals_.find(key);
  if (known != residuals_.end()) return known->second;
  return residuals_.emplace(std::move(key), whole_residual(model, experiment)).first->second;
}

void GapMeter::look_ahead(const std::vector<const Model*>& sized,
                          const std::vector<const Model*>& held_out) const {
  std::map<Key, Model> wanted;
  const auto want = [&](const Model& model, const Experiment& experiment) {
    Key key = {chain::model_text(model.chain()), &experiment};
    if (residuals_.count(key) == 0) wanted.emplace(std::move(key), model);
  };
  for (const auto* models : {&sized, &held_out}) {
    for (const Model* model : *models) {
      const Model written = for_record(*model, study_.holdout().front());
      for (const auto& e : study_.holdout()) want(written, e);
    }
  }
  for (const Model* model : sized) {
    for (const auto& e : study_.train()) want(for_record(*model, e), e);
  }
  const std::vector<std::pair<Key, Model>> all(wanted.begin(), wanted.end());
  std::vector<std::vector<double>> found(all.size());
  parallel_for(all.size(), allowed_threads(),
               [&](std::size_t i) { found[i] = whole_residual(all[i].second, *all[i].first.second); });
  for (std::size_t i = 0; i < all.size(); ++i) residuals_.emplace(all[i].first, std::move(found[i]));
}

std::size_t GapMeter::scoring_start(const Model& final, const TimeExperiment& time,
                                    const Experiment& experiment, bool split) const {
  if (time.first() == 0) return 0;
  const std::span<const double> all = residual(final, experiment);
  const bool stands_out = rms(all.first(time.first())) > kStartStandsOut * rms(all.subspan(time.first()));
  return split || stands_out ? time.first() : 0;
}

/// `split`: the samples before the scored ones belong to the training records.
std::vector<std::size_t> GapMeter::scoring_starts(const Model& final, const Experiments& experiments,
                                                  bool split) const {
  std::vector<std::size_t> starts;
  for (const auto& e : experiments) {
    starts.push_back(
        std::visit(Visitor{[&](const TimeExperiment& time) { return scoring_start(final, time, e, split); },
                           [](const FrequencyExperiment&) { return std::size_t{0}; }},
                   e));
  }
  return starts;
}

std::pair<double, double> GapMeter::pooled_rms(const Model& model, const Experiments& experiments,
                                               const std::vector<std::size_t>& from, bool own_lines) const {
  std::vector<double> scored;
  std::vector<double> whole;
  for (std::size_t i = 0; i < experiments.size(); ++i) {
    const auto& e = residual(own_lines ? for_record(model, experiments[i]) : model, experiments[i]);
    scored.insert(scored.end(), e.begin() + static_cast<std::ptrdiff_t>(from[i]), e.end());
    whole.insert(whole.end(), e.begin(), e.end());
  }
  return {rms(scored), rms(whole)};
}

GapMeter::GapMeter(const Study& study, const Model& final)
    : study_(study),
      train_from_(scoring_starts(final, study.train(), false)),
      holdout_from_(scoring_starts(final, study.holdout(), study.split())) {}

std::pair<double, double> GapMeter::pooled_holdout_rms(const Model& model) const {
  const Model written = for_record(model, study_.holdout().front());
  return pooled_rms(written, study_.holdout(), holdout_from_, false);
}

double GapMeter::holdout_rms(const Model& model) const {
  return pooled_holdout_rms(model).first;
}

GapSize GapMeter::size(const Model& model) const {
  GapSize s;
  // Training records have lines of their own; the held-out ones are compared with what model.toml holds.
  std::tie(s.train_rms, s.train_whole_rms) = pooled_rms(model, study_.train(), train_from_, true);
  std::tie(s.holdout_rms, s.holdout_whole_rms) = pooled_holdout_rms(model);
  s.holdout_percent_of_range = 100.0 * s.holdout_rms / largest_range(study_.holdout());
  return s;
}

std::vector<Cell> GapMeter::where(const Model& model) const {
  double largest = -1.0;
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < study_.holdout().size(); ++i) {
    const auto& experiment = study_.holdout()[i];
    const auto& e = residual(for_record(model, experiment), experiment);
    const double size = rms(e);
    if (size <= largest) continue;
    largest = size;
    cells = std::visit([&](const auto& kind) { return where_in(kind, e, holdout_from_[i]); }, experiment);
  }
  return cells;
}

std::vector<double> GapMeter::holdout_residual(const Model& model, std::size_t record) const {
  const Model written = for_record(model, study_.holdout().front());
  const auto& e = residual(written, study_.holdout()[record]);
  return {e.begin() + static_cast<std::ptrdiff_t>(holdout_from_[record]), e.end()};
}

std::vector<ScoredFrom> GapMeter::scored_from() const {
  std::vector<ScoredFrom> all;
  const auto add = [&](const Experiments& experiments, const std::vector<std::size_t>& from, bool held_out) {
    for (std::size_t i = 0; i < experiments.size(); ++i) {
      if (const auto* time = std::get_if<TimeExperiment>(&experiments[i]))
        all.push_back({time->file(), held_out, time->record().time_s(from[i])});
    }
  };
  add(study_.train(), train_from_, false);
  add(study_.holdout(), holdout_from_, true);
  return all;
}

}  // namespace bodesmith::gap
