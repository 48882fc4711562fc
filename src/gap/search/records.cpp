#include "gap/search/records.hpp"

#include <algorithm>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/stretches.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Of a fit. With 30 flat forms (a fractional order, a spectrum of relaxations) end before their least and are taken for each other; twice as
/// many take as much longer.
constexpr int kIterations = 40;

}  // namespace

Experiments as_searched(Experiments experiments) {
  for (auto& e : experiments) {
    std::visit(Visitor{[](TimeExperiment& time) { time.score_start(); },
                       [](FrequencyExperiment& response) { response.set_logarithmic(); }},
               e);
  }
  return experiments;
}

SearchRecords make_records(const Experiments& train, const Model& model) {
  SearchRecords records{as_searched(train), {}};
  records.stretches = stretches_of(records.train, model);
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
  std::vector<double> now = residuals(holds);
  for (std::size_t doubled = 0; doubled < kFew; ++doubled, holds *= 2) {
    std::vector<double> finer = residuals(2 * holds);
    if (now.size() != finer.size()) break;
    for (std::size_t i = 0; i < now.size(); ++i) now[i] -= finer[i];
    if (!(rms(now) > kExplained * rms(finer))) break;
    now = std::move(finer);
  }
  return holds;
}

LeastSquaresOptions fit_options(const SearchOptions& options) {
  LeastSquaresOptions o;
  o.max_iterations = kIterations;
  o.stop = [&options] { return options.is_late(); };
  return o;
}

LeastSquaresOptions few_steps(const SearchOptions& options) {
  LeastSquaresOptions o = fit_options(options);
  o.max_iterations = static_cast<int>(kFew);
  return o;
}

FittedModel fit_in_turn(const SearchSetting& setting, const SearchRecords& records, Model model) {
  const auto& options = setting.options;
  auto rough = fit(std::move(model), records.look(), fit_options(options));
  if (!records.are_long()) return rough;
  return fit(std::move(rough.model), records.train, few_steps(options));
}

}  // namespace bodesmith::gap
