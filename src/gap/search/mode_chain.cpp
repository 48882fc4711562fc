#include "gap/search/mode_chain.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/round.hpp"

namespace bodesmith::gap {
namespace {

/// Modes in series are told by the magnitude alone, whose logarithm is a sum over them; modes side by side by the ratio,
/// which is a sum over them.
struct KindOfChain {
  std::string_view mode;
  FrequencyExperiment::Compared compared;
};
constexpr std::array kKinds = {KindOfChain{"resonance", FrequencyExperiment::Compared::magnitude},
                               KindOfChain{"parallel_mode", FrequencyExperiment::Compared::ratio}};

SearchRecords compared_by(FrequencyExperiment::Compared compared, const SearchRecords& records) {
  SearchRecords out = records;
  for (auto* list : {&out.train, &out.stretches}) {
    for (auto& e : *list) {
      if (auto* response = std::get_if<FrequencyExperiment>(&e)) response->set_compared(compared);
    }
  }
  return out;
}

/// The model with one mode more; nothing when none helps.
std::optional<Ranked> with_mode(const SearchSetting& setting, std::string_view name,
                                const SearchRecords& compared, const Model& model) {
  const double left = rms_of(model, compared.train);
  auto ranking =
      fit_round(
          setting, compared, model, [&](const Effect& effect) { return effect.name() == name; }, 0.0)
          .ranking;
  const auto best = std::min_element(ranking.begin(), ranking.end(), [](const Ranked& a, const Ranked& b) {
    return a.train_rms < b.train_rms;
  });
  // It takes at least what a name must explain, compared in that way.
  if (best == ranking.end() || !(best->train_rms < (1.0 - setting.options.bounds.explained) * left))
    return std::nullopt;
  auto fitted = fit(best->model, compared.train, fit_options(setting.options, setting.options.iterations));
  if (fitted.usable()) best->model = std::move(fitted.model);
  return *best;
}

/// Chains that begin at a model.
void extend_from(const SearchSetting& setting, const SearchRecords& records, const KindOfChain& kind,
                 Model model, std::vector<std::vector<Ranked>>& chains) {
  const auto compared = compared_by(kind.compared, records);
  std::vector<Ranked> chain;
  const int most = setting.options.max_terms - static_cast<int>(model.terms().size());
  while (static_cast<int>(chain.size()) < most && !setting.options.is_late()) {
    auto mode = with_mode(setting, kind.mode, compared, model);
    if (!mode) return;
    model = mode->model;
    chain.push_back(std::move(*mode));
    auto fitted = fit(model, records.train, fit_options(setting.options, setting.options.iterations));
    if (!fitted.usable()) continue;
    auto finished = chain;
    finished.back().model = std::move(fitted.model);
    chains.push_back(std::move(finished));
  }
}

}  // namespace

std::vector<std::vector<Ranked>> mode_chains(const SearchSetting& setting, const SearchRecords& records,
                                             const Model& before) {
  std::vector<std::vector<Ranked>> chains;
  for (const auto& kind : kKinds) extend_from(setting, records, kind, before, chains);
  return chains;
}

}  // namespace bodesmith::gap
