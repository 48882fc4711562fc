#include "gap/search/start_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "base/text.hpp"
#include "gap/evidence/score.hpp"
#include "gap/model/model_fit.hpp"
#include "gap/records/settling.hpp"
#include "gap/runner.hpp"
#include "gap/search/record_starts.hpp"

namespace bodesmith::gap {
namespace {

using chain::Start;

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

/// A model from one of the two starts, held against the whole training records.
struct Tried {
  double rms = 0.0;
  double log_evidence = 0.0;
  bool explains = true;  ///< no start stands out
};

Tried tried(const Model& model, const Experiments& train) {
  SearchRecords records{as_searched(train), {}};
  return {rms_of(model, records.train), log_evidence(model, records.train),
          !leave_out_wrong_starts(records, model)};
}

/// The same model from another start, refitted and not searched again.
Tried from_other_start(Model model, Start start, const Experiments& train, const SearchOptions& options) {
  model.set_start(start);
  const SearchSetting setting{options};
  const SearchRecords records = make_records(train, model);
  return tried(fit_in_turn(setting, records, model).model, train);
}

}  // namespace

std::pair<SearchResult, std::optional<StartChoice>> search_from_start(const chain::Chain& base,
                                                                      const Experiments& train,
                                                                      const SearchOptions& options) {
  if (base.start || !any_begins_under_bias(train)) return {search(base, train, options), std::nullopt};
  const auto at_rest = started(base, Start::equilibrium);
  const Start first = rms_of(Model(at_rest), as_searched(train)) < rms_of(Model(base), as_searched(train))
                          ? Start::equilibrium
                          : Start::zero;
  const Start other = first == Start::zero ? Start::equilibrium : Start::zero;
  const auto from = [&](Start start) { return start == Start::zero ? base : at_rest; };
  StartChoice choice{.chosen = first};
  SearchResult found = search(from(first), train, options);
  const Tried of_first = tried(found.final, train);
  Tried of_other = from_other_start(found.final, other, train, options);
  const bool enough = of_first.explains && !(of_other.log_evidence > of_first.log_evidence);
  if (!enough && !found.stopped && !found.late) {
    SearchResult again = search(from(other), train, options);
    if (!again.stopped) {
      of_other = tried(again.final, train);
      choice.by_search = true;
      if (of_other.log_evidence > of_first.log_evidence) {
        choice.chosen = other;
        found = std::move(again);
      }
    }
  }
  choice.zero_rms = (first == Start::zero ? of_first : of_other).rms;
  choice.equilibrium_rms = (first == Start::zero ? of_other : of_first).rms;
  found.initial = Model(base);  // as given
  return {std::move(found), choice};
}

std::string to_text(const StartChoice& choice) {
  return fmt::format(
      "The training records begin under bias: started in zero what was found leaves {} rms of them, started in equilibrium with the "
      "first input {}, transients included; as noise, which may wander, what is left is likelier from {}.",
      rounded_text(choice.zero_rms), rounded_text(choice.equilibrium_rms),
      choice.chosen == Start::equilibrium ? "equilibrium (start in model.toml)"
                                          : "zero, where a model starts that says nothing else");
}

}  // namespace bodesmith::gap
