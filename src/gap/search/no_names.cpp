#include "gap/search/no_names.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

#include "gap/scene.hpp"
#include "gap/search/base_fit.hpp"
#include "gap/search/grow.hpp"

namespace bodesmith::gap {

std::optional<std::size_t> term_without_name(const Model& model, const Experiments& records) {
  if (are_responses(records)) return std::nullopt;
  auto scene = make_scene(model, records);
  // What was accepted as a first name may be as little as those are allowed to be.
  scene.takes_most = true;
  const auto& terms = model.terms();
  for (std::size_t k = 0; k < terms.size(); ++k) {
    if (terms[k].effect->is_no_name(model, terms[k], scene)) return k;
  }
  return std::nullopt;
}

void take_out_no_names(const SearchSetting& setting, State& state) {
  // What grows in the place of one may lose its name in turn.
  constexpr int kTurns = 3;
  for (int turn = 0; turn < kTurns && !setting.options.is_late(); ++turn) {
    const auto k = term_without_name(state.found.model, state.records.train);
    if (!k || *k >= state.found.steps.size()) return;
    const Effect& effect = *state.found.model.terms()[*k].effect;
    state.found.notes.push_back(fmt::format(
        "{} was taken out: beside the other terms its values are another effect's form", effect.name()));
    state.found.model.remove(*k);
    state.found.model = settle(setting, state.records, std::move(state.found.model));
    state.found.steps.erase(state.found.steps.begin() + static_cast<std::ptrdiff_t>(*k));
    state.other_way = true;
    grow(setting, state);
  }
}

}  // namespace bodesmith::gap
