#include "gap/start_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.hpp"
#include "gap/runner.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/record_starts.hpp"
#include "gap/settling.hpp"

namespace bodesmith::gap {
namespace {

using chain::Start;

/// The base model decides when one start leaves this many times as much as the other: even a model that misses
/// something shows so the answer to a step that was none, or that none was there.
constexpr double kPlain = 1.5;
/// Of two searches, one that names more must leave less than this part for each term more; with as many,
constexpr double kWorthATerm = 0.9;
/// equilibrium must leave less than this part.
constexpr double kWorthAKey = 0.98;

bool any_begins_under_bias(const Experiments& train) {
  return std::any_of(train.begin(), train.end(), [](const Experiment& e) {
    const auto* time = std::get_if<TimeExperiment>(&e);
    return time != nullptr && begins_under_bias(time->record());
  });
}

chain::Chain started(chain::Chain base, Start start) {
  base.start = start;
  return base;
}

/// What a model leaves of the records from their first samples on.
double whole_rms(const Model& model, Experiments train) {
  for (auto& e : train) {
    if (auto* time = std::get_if<TimeExperiment>(&e)) time->score_start();
  }
  return rms_of(model, train);
}

/// A model from one of the two starts, held against the training records.
struct Tried {
  double rms = 0.0;      ///< from their first samples on
  bool explains = true;  ///< no start stands out
};

Tried tried(const Model& model, const Experiments& train, const SearchOptions& options) {
  const SearchSetting setting{options, model};
  return {whole_rms(model, train),
          !leave_out_wrong_starts(setting, make_records(train, options.stretches), model).found};
}

Tried tried_base(const chain::Chain& base, const Experiments& train, const SearchOptions& options) {
  const Model initial(base);
  const SearchSetting setting{options, initial};
  return tried(fit_base(setting, make_records(train, options.stretches)).model, train, options);
}

/// Whether what a search from equilibrium found is to be preferred.
bool is_equilibrium_better(const SearchResult& equilibrium, const Tried& from_equilibrium,
                           const SearchResult& zero, const Tried& from_zero) {
  // Where neither explains how the records begin, they say nothing of it.
  if (!from_equilibrium.explains) return false;
  if (!from_zero.explains) return true;
  const double more = static_cast<double>(equilibrium.steps.size()) - static_cast<double>(zero.steps.size());
  const double worth = more == 0.0 ? kWorthAKey : std::pow(kWorthATerm, more);
  return from_equilibrium.rms < worth * from_zero.rms;
}

/// The progress of one of two searches.
SearchOptions half(const SearchOptions& options, double from) {
  SearchOptions out = options;
  if (options.progress) out.progress = [&options, from](double part) { options.report(from + 0.5 * part); };
  return out;
}

}  // namespace

StartedSearch search_from_start(const chain::Chain& base, const Experiments& train,
                                const SearchOptions& options) {
  if (base.start || !any_begins_under_bias(train)) return {search(base, train, options), std::nullopt};
  const auto at_rest = started(base, Start::equilibrium);
  StartChoice choice;
  const auto measure = [&](const Tried& from_zero, const Tried& from_equilibrium) {
    choice.zero_rms = from_zero.rms;
    choice.equilibrium_rms = from_equilibrium.rms;
  };
  const auto decided = [&](Start start, SearchResult found) {
    choice.chosen = start;
    found.initial = Model(base);  // as given
    return StartedSearch{std::move(found), choice};
  };
  const Tried base_from_zero = tried_base(base, train, options);
  const Tried base_from_equilibrium = tried_base(at_rest, train, options);
  measure(base_from_zero, base_from_equilibrium);
  if (base_from_equilibrium.explains && base_from_zero.rms > kPlain * base_from_equilibrium.rms)
    return decided(Start::equilibrium, search(at_rest, train, options));
  if (base_from_zero.explains && base_from_equilibrium.rms > kPlain * base_from_zero.rms)
    return decided(Start::zero, search(base, train, options));
  auto zero = search(base, train, half(options, 0.0));
  if (zero.stopped || zero.late) return decided(Start::zero, std::move(zero));
  auto equilibrium = search(at_rest, train, half(options, 0.5));
  if (equilibrium.stopped) return decided(Start::zero, std::move(zero));
  const Tried from_zero = tried(zero.final, train, options);
  const Tried from_equilibrium = tried(equilibrium.final, train, options);
  choice.by_terms = true;
  measure(from_zero, from_equilibrium);
  if (is_equilibrium_better(equilibrium, from_equilibrium, zero, from_zero))
    return decided(Start::equilibrium, std::move(equilibrium));
  return decided(Start::zero, std::move(zero));
}

std::string to_text(const StartChoice& choice) {
  const bool still = choice.chosen == Start::equilibrium;
  return fmt::format(
      "The training records begin under bias: {} leaves {} rms of them, starts and all, from zero and {} from equilibrium "
      "under the first input; {}.",
      choice.by_terms ? "what was found" : "the base model", rounded_text(choice.zero_rms),
      rounded_text(choice.equilibrium_rms),
      still ? "the model starts there (start in model.toml)"
            : "the model starts in zero, as it does without a word");
}

}  // namespace bodesmith::gap
