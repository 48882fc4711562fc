#include "gap/search/records.hpp"

#include <algorithm>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/stretches.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Part of the rms left that no longer counts, as it adds by squares.
constexpr double kOwnShare = 0.3;
/// Beyond them the search would take longer than it may.
constexpr std::size_t kMostHolds = 8;

}  // namespace

Experiments as_searched(Experiments experiments) {
  for (auto& e : experiments) {
    std::visit(Visitor{[](TimeExperiment& time) { time.score_start(); },
                       [](FrequencyExperiment& response) { response.set_logarithmic(); }},
               e);
  }
  return experiments;
}

SearchRecords make_records(const Experiments& train, const StretchOptions& options, const Model& model) {
  SearchRecords records{as_searched(train), {}};
  records.stretches = stretches_of(records.train, model, options);
  return records;
}

std::size_t enough_holds(const Model& model, const Experiments& train) {
  if (are_responses(train)) return 1;
  const auto residuals = [&](std::size_t holds) {
    Experiments records = train;
    set_holds(records, holds);
    return residuals_of(model, records);
  };
  std::size_t holds = holds_of(train);
  for (std::vector<double> now = residuals(holds); holds < kMostHolds; holds *= 2) {
    std::vector<double> finer = residuals(2 * holds);
    if (now.size() != finer.size()) break;
    for (std::size_t i = 0; i < now.size(); ++i) now[i] -= finer[i];
    if (!(rms(now) > kOwnShare * rms(finer))) break;
    now = std::move(finer);
  }
  return holds;
}

LeastSquaresOptions fit_options(const SearchOptions& options, int iterations) {
  LeastSquaresOptions o;
  o.max_iterations = iterations;
  o.stop = [&options] { return options.is_late(); };
  return o;
}

FittedModel fit_in_turn(const SearchSetting& setting, const SearchRecords& records, Model model,
                        int iterations) {
  const auto& options = setting.options;
  if (iterations == 0) iterations = options.refit_iterations;
  if (!records.are_long()) return fit(std::move(model), records.train, fit_options(options, iterations));
  auto rough = fit(std::move(model), records.stretches, fit_options(options, iterations));
  return fit(std::move(rough.model), records.train,
             fit_options(options, std::min(iterations, options.few_iterations)));
}

}  // namespace bodesmith::gap
