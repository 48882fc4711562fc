#include "gap/search/records.hpp"

#include <algorithm>
#include <utility>

#include "gap/scene.hpp"

namespace bodesmith::gap {
namespace {

/// As searches score them: starts included, responses by their logarithm.
Experiments as_searched(Experiments experiments) {
  for (auto& e : experiments) {
    std::visit(Visitor{[](TimeExperiment& time) { time.score_start(); },
                       [](FrequencyExperiment& response) {
                         response.set_compared(FrequencyExperiment::Compared::logarithm);
                       }},
               e);
  }
  return experiments;
}

Experiment stretch_of(const TimeExperiment& experiment, std::size_t samples, std::size_t min_lead) {
  const std::size_t lead = std::max(experiment.start(), min_lead);
  TimeRecord used = experiment.record();
  used.u.resize(experiment.end());
  used.y.resize(experiment.end());
  TimeExperiment stretch(lively_stretch(used, lead, samples), lead);
  stretch.set_coarse();
  return stretch;
}

}  // namespace

SearchRecords make_records(const Experiments& train, const StretchOptions& options) {
  SearchRecords records{as_searched(train), {}};
  if (scored_samples(records.train) <= 3 * options.samples / 2) return records;
  const std::size_t each = std::max(options.min_samples_each, options.samples / train.size());
  for (const auto& e : records.train) {
    records.stretches.push_back(std::visit(
        Visitor{[&](const TimeExperiment& time) { return stretch_of(time, each, options.min_lead); },
                [](const FrequencyExperiment& response) { return Experiment(response); }},
        e));
  }
  return records;
}

LeastSquaresOptions fit_options(const SearchOptions& options, int iterations) {
  LeastSquaresOptions o;
  o.iterations = iterations;
  o.stop = [&options] { return options.is_late(); };
  return o;
}

FittedModel fit_in_turn(const SearchSetting& setting, const SearchRecords& records, Model model,
                        int iterations) {
  const auto& options = setting.options;
  if (!records.are_long()) return fit(std::move(model), records.train, fit_options(options, iterations));
  auto rough = fit(std::move(model), records.stretches, fit_options(options, iterations));
  return fit(std::move(rough.model), records.train,
             fit_options(options, std::min(iterations, options.stretches.iterations_on_all)));
}

}  // namespace bodesmith::gap
