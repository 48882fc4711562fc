#include "gap/report/size.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/text.hpp"
#include "gap/evidence/noise_floor.hpp"
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

/// The first samples that are scored. `split`: those before them belong to the training records.
std::vector<std::size_t> scoring_starts(const Experiments& experiments,
                                        const std::vector<std::vector<double>>& residuals, bool split) {
  std::vector<std::size_t> starts(experiments.size(), 0);
  for (std::size_t i = 0; i < experiments.size(); ++i) {
    const auto* time = std::get_if<TimeExperiment>(&experiments[i]);
    const std::size_t first = time != nullptr ? time->first() : 0;
    const std::span all = residuals[i];
    if (first > 0 && (split || rms(all.first(first)) > kOverFloor * rms(all.subspan(first))))
      starts[i] = first;
  }
  return starts;
}

/// rms of all records together, each from a sample on.
double pooled_rms(const std::vector<std::vector<double>>& residuals, const std::vector<std::size_t>& from) {
  std::vector<double> all;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    all.insert(all.end(), residuals[i].begin() + static_cast<std::ptrdiff_t>(from[i]), residuals[i].end());
  return rms(all);
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

WholeResiduals whole_residuals(const Model& model, const Study& study) {
  const std::size_t count = study.train().size();
  WholeResiduals all{std::vector<std::vector<double>>(count),
                     std::vector<std::vector<double>>(study.holdout().size())};
  const Model written = with_lines_of(model, study.holdout().front());
  parallel_for(count + study.holdout().size(), allowed_threads(), [&](std::size_t i) {
    const bool held_out = i >= count;
    const Experiment& e = held_out ? study.holdout()[i - count] : study.train()[i];
    auto& residual = held_out ? all.holdout[i - count] : all.train[i];
    const Model own = held_out ? written : with_lines_of(model, e);
    residual = std::visit([&](const auto& kind) { return whole_residual(own, kind); }, e);
  });
  return all;
}

GapMeter::GapMeter(const Study& study, const WholeResiduals& final)
    : study_(study),
      train_from_(scoring_starts(study.train(), final.train, false)),
      holdout_from_(scoring_starts(study.holdout(), final.holdout, study.split())) {}

GapSize GapMeter::size(const WholeResiduals& residuals) const {
  const std::vector<std::size_t> train_whole(train_from_.size(), 0), holdout_whole(holdout_from_.size(), 0);
  GapSize s;
  s.train_rms = pooled_rms(residuals.train, train_from_);
  s.train_whole_rms = pooled_rms(residuals.train, train_whole);
  s.holdout_rms = pooled_rms(residuals.holdout, holdout_from_);
  s.holdout_whole_rms = pooled_rms(residuals.holdout, holdout_whole);
  s.holdout_percent_of_range = 100.0 * s.holdout_rms / largest_range(study_.holdout());
  return s;
}

std::vector<Cell> GapMeter::where(const WholeResiduals& residuals) const {
  const auto& all = residuals.holdout;
  const auto largest = static_cast<std::size_t>(
      std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return rms(a) < rms(b); }) -
      all.begin());
  if (!std::isfinite(rms(all[largest]))) return {};
  const std::size_t from = holdout_from_[largest];
  return std::visit(
      Visitor{[&](const TimeExperiment& e) {
                return gap::where(e.record(), all[largest], from,
                                  find_period(std::span(e.record().u).subspan(from)));
              },
              [&](const FrequencyExperiment& e) { return gap::where(e.record(), all[largest]); }},
      study_.holdout()[largest]);
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

std::vector<ConstantOffset> constant_offsets(const GapMeter& meter, const WholeResiduals& final,
                                             const Study& study) {
  std::vector<ConstantOffset> out;
  for (std::size_t i = 0; i < study.holdout().size(); ++i) {
    const auto* time = std::get_if<TimeExperiment>(&study.holdout()[i]);
    if (time == nullptr) continue;
    const auto residual = std::span(final.holdout[i]).subspan(meter.holdout_from(i));
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
