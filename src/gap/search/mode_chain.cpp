#include "gap/search/mode_chain.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/round.hpp"

namespace bodesmith::gap {
namespace {

constexpr std::string_view kMode = "resonance";
/// A mode takes at least this part of what the magnitude leaves.
constexpr double kWorthIt = 0.85;
constexpr int kModeIterations = 40;

SearchRecords by_magnitude(const SearchRecords& records) {
  SearchRecords out = records;
  for (auto* list : {&out.train, &out.stretches}) {
    for (auto& e : *list) {
      if (auto* response = std::get_if<FrequencyExperiment>(&e))
        response->set_compared(FrequencyExperiment::Compared::magnitude);
    }
  }
  return out;
}

/// The model with one mode more; nothing when none helps.
std::optional<Ranked> with_mode(const SearchSetting& setting, const SearchRecords& magnitudes,
                                const Model& model) {
  const double left = rms_of(model, magnitudes.train);
  auto ranking =
      fit_round(
          setting, magnitudes, model, [](const Effect& effect) { return effect.name() == kMode; }, 0.0)
          .ranking;
  const auto best = std::min_element(ranking.begin(), ranking.end(), [](const Ranked& a, const Ranked& b) {
    return a.train_rms < b.train_rms;
  });
  if (best == ranking.end() || !(best->train_rms < kWorthIt * left)) return std::nullopt;
  auto fitted = fit(best->model, magnitudes.train, fit_options(setting.options, kModeIterations));
  if (fitted.result.usable()) best->model = std::move(fitted.model);
  return *best;
}

/// Chains that begin at a model.
void extend_from(const SearchSetting& setting, const SearchRecords& records, const SearchRecords& magnitudes,
                 Model model, std::vector<std::vector<Ranked>>& chains) {
  std::vector<Ranked> chain;
  const auto before = round_residuals(model, records);
  const int most = setting.options.max_terms - static_cast<int>(model.terms().size());
  while (static_cast<int>(chain.size()) < most && !setting.options.is_late()) {
    auto mode = with_mode(setting, magnitudes, model);
    if (!mode) return;
    model = mode->model;
    chain.push_back(std::move(*mode));
    auto fitted = fit(model, records.train, fit_options(setting.options, kModeIterations));
    if (!fitted.result.usable()) continue;
    auto finished = chain;
    finished.back().model = std::move(fitted.model);
    if (auto last = with_gains(finished.back(), records, before)) {
      finished.back() = with_folds(std::move(*last), records, before);
      chains.push_back(std::move(finished));
    }
  }
}

}  // namespace

std::vector<std::vector<Ranked>> mode_chains(const SearchSetting& setting, const SearchRecords& records,
                                             const Model& before) {
  SearchOptions open = setting.options;
  open.round.min_promise = open.round.min_promise_later = 0.0;
  const SearchSetting wide{open, setting.initial, setting.first_gap};
  const auto magnitudes = by_magnitude(records);
  std::vector<std::vector<Ranked>> chains;
  extend_from(wide, records, magnitudes, before, chains);
  // Free parameters that went astray after what is missing: once from where they were given.
  if (before.terms().empty() && before.free_count() > 0)
    extend_from(wide, records, magnitudes, setting.initial, chains);
  return chains;
}

}  // namespace bodesmith::gap
