#include "gap/report/size.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/text.hpp"
#include "chain/model_file.hpp"
#include "gap/runner.hpp"
#include "gap/search_options.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/period.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"
#include "simulate/simulate.hpp"

namespace bodesmith::gap {
namespace {

std::vector<double> whole_residual(const Model& model, const FrequencyExperiment& experiment) {
  auto e = residuals_of(model, {experiment});
  for (double& x : e) x = -x;
  return e;
}

std::vector<double> whole_residual(const Model& model, const Experiment& experiment) {
  return std::visit([&](const auto& kind) { return whole_residual(model, kind); }, experiment);
}

}  // namespace

std::vector<double> whole_residual(const Model& model, const TimeExperiment& experiment) {
  simulate::Options options;
  options.estimate_error = false;
  const auto& record = experiment.record();
  std::vector<double> e(experiment.end(), std::numeric_limits<double>::infinity());
  try {
    const auto result = simulate::simulate(model.chain(), record, options);
    for (std::size_t i = 0; i < e.size(); ++i) e[i] = record.y[i] - result.y[i];
  } catch (const simulate::RunsAway&) {
    if (model.terms().empty()) throw;
  }
  return e;
}

std::vector<std::span<const double>> GapMeter::residuals(const Model& model, const Experiments& experiments,
                                                         bool own_lines) const {
  std::vector<Key> keys;
  std::map<Key, Model> missing;
  for (const auto& e : experiments) {
    Model written = own_lines ? with_lines_of(model, e) : model;
    keys.emplace_back(chain::model_text(written.chain()), &e);
    if (residuals_.count(keys.back()) == 0) missing.emplace(keys.back(), std::move(written));
  }
  const std::vector<std::pair<Key, Model>> all(missing.begin(), missing.end());
  std::vector<std::vector<double>> found(all.size());
  parallel_for(all.size(), allowed_threads(),
               [&](std::size_t i) { found[i] = whole_residual(all[i].second, *all[i].first.second); });
  for (std::size_t i = 0; i < all.size(); ++i) residuals_.emplace(all[i].first, std::move(found[i]));
  std::vector<std::span<const double>> out;
  for (const auto& key : keys) out.emplace_back(residuals_.at(key));
  return out;
}

std::vector<std::span<const double>> GapMeter::holdout_residuals(const Model& model) const {
  return residuals(with_lines_of(model, study_.holdout().front()), study_.holdout(), false);
}

/// `split`: the samples before the scored ones belong to the training records.
std::vector<std::size_t> GapMeter::scoring_starts(const Model& final, const Experiments& experiments,
                                                  bool split) const {
  const auto all = residuals(final, experiments, false);
  std::vector<std::size_t> starts(experiments.size(), 0);
  for (std::size_t i = 0; i < experiments.size(); ++i) {
    const auto* time = std::get_if<TimeExperiment>(&experiments[i]);
    const std::size_t first = time != nullptr ? time->first() : 0;
    if (first > 0 &&
        (split || rms(all[i].first(first)) > SearchOptions().start_stands_out * rms(all[i].subspan(first))))
      starts[i] = first;
  }
  return starts;
}

/// rms of all records together, from their scoring starts on, and whole.
std::pair<double, double> GapMeter::pooled_rms(const std::vector<std::span<const double>>& residuals,
                                               const std::vector<std::size_t>& from) {
  std::vector<double> scored;
  std::vector<double> whole;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    scored.insert(scored.end(), residuals[i].begin() + static_cast<std::ptrdiff_t>(from[i]),
                  residuals[i].end());
    whole.insert(whole.end(), residuals[i].begin(), residuals[i].end());
  }
  return {rms(scored), rms(whole)};
}

GapMeter::GapMeter(const Study& study, const Model& final)
    : study_(study),
      train_from_(scoring_starts(final, study.train(), false)),
      holdout_from_(scoring_starts(final, study.holdout(), study.split())) {}

GapSize GapMeter::size(const Model& model) const {
  GapSize s;
  // Training records have lines of their own; the held-out ones are compared with what model.toml holds.
  std::tie(s.train_rms, s.train_whole_rms) = pooled_rms(residuals(model, study_.train(), true), train_from_);
  std::tie(s.holdout_rms, s.holdout_whole_rms) = pooled_rms(holdout_residuals(model), holdout_from_);
  s.holdout_percent_of_range = 100.0 * s.holdout_rms / largest_range(study_.holdout());
  return s;
}

std::vector<Cell> GapMeter::where(const Model& model) const {
  const auto all = residuals(model, study_.holdout(), true);
  const auto largest = static_cast<std::size_t>(
      std::max_element(all.begin(), all.end(), [](auto a, auto b) { return rms(a) < rms(b); }) - all.begin());
  if (!std::isfinite(rms(all[largest]))) return {};
  const std::vector<double> residual(all[largest].begin(), all[largest].end());
  const std::size_t from = holdout_from_[largest];
  return std::visit(Visitor{[&](const TimeExperiment& e) {
                              return gap::where(e.record(), residual, from,
                                                find_period(std::span(e.record().u).subspan(from)));
                            },
                            [&](const FrequencyExperiment& e) { return gap::where(e.record(), residual); }},
                    study_.holdout()[largest]);
}

std::span<const double> GapMeter::holdout_residual(const Model& model, std::size_t record) const {
  return holdout_residuals(model)[record].subspan(holdout_from_[record]);
}

Experiments GapMeter::holdout() const {
  Experiments all = study_.holdout();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (auto* time = std::get_if<TimeExperiment>(&all[i]); time != nullptr && holdout_from_[i] == 0)
      time->score_start();
  }
  return all;
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

std::vector<ConstantOffset> constant_offsets(const GapMeter& meter, const Model& model, const Study& study) {
  std::vector<ConstantOffset> out;
  for (std::size_t i = 0; i < study.holdout().size(); ++i) {
    const auto* time = std::get_if<TimeExperiment>(&study.holdout()[i]);
    if (time == nullptr) continue;
    const auto residual = meter.holdout_residual(model, i);
    const double middle = mean(residual), whole = rms(residual);
    const double share = middle * middle / (whole * whole);
    if (!(share >= kMostOfGap)) continue;
    out.push_back({time->file(), middle, share, whole * std::sqrt(std::max(0.0, 1.0 - share))});
  }
  return out;
}

std::string to_text(const ConstantOffset& offset) {
  return fmt::format(
      "A constant offset of {} is {:.0f} % of the gap that is left on {}; without it {} rms would be left, as when the zero "
      "moves between records (drift, creep, another preload), which no term of the model can know.",
      rounded_text(offset.value, 3), 100.0 * offset.share, offset.file, rounded_text(offset.rms_without, 3));
}

}  // namespace bodesmith::gap
