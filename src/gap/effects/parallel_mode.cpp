#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/effects/modes.hpp"

namespace bodesmith::gap {
namespace {

const char* const kShares = "gains";
const char* const kModeFrequencies = "natural_frequencies_hz";
const char* const kModeDampings = "damping_ratios";

/// One mode of a `parallel_modes` block, which several terms may share: H = 1 + R sum of all of theirs.
struct ModePlace {
  int block = 0;
  std::size_t mode = 0;
  std::optional<int> resonator;  ///< that they stand in parallel with

  void write(Model& model, double hz, double damping, double gain) const {
    chain::Block& b = model.block(block);
    if (resonator) set_resonator(b, model.block(*resonator));
    put(b, kModeFrequencies, hz);
    put(b, kModeDampings, damping);
    put(b, kShares, gain);
  }
  static void set_resonator(chain::Block& b, const chain::Block& resonator) {
    b.set("resonator_hz", resonator.get("natural_frequency_hz"))
        .set("resonator_damping_ratio", resonator.get("damping_ratio"));
  }

 private:
  /// A mode in front that another term had keeps its place, without a share.
  void put(chain::Block& b, const char* key, double value) const {
    auto values = b.list(key);
    if (mode >= values.size()) values.resize(mode + 1, key == kShares ? 0.0 : value);
    values[mode] = value;
    b.set(key, values);
  }
};

/// Of either sign.
Starts mode_starts(const Scene& scene) {
  Starts starts;
  for (double hz : mode_frequencies_hz(scene)) {
    for (double damping : {0.02, 0.1}) {
      for (double gain : {0.2, -0.2}) starts.push_back({hz, damping, gain});
    }
  }
  return starts;
}

bool is_linear_mode(const Scene& scene, std::size_t at) {
  const auto& block = scene.model->at(at);
  return block.has("natural_frequency_hz") && block.has("damping_ratio") && scene.model->is_linear(at);
}

/// The base model's resonator that a block of this effect stands in parallel with: other terms may have come between the two.
std::optional<int> parallel_resonator(const Model& model, int block) {
  std::size_t at = model.position_of(block);
  if (!(model.at(at).get("resonator_hz") > 0.0)) return std::nullopt;
  while (!model.is_base(at)) --at;
  return model.id_at(at);
}

void add_proposal(const Scene& scene, Model model, int block, std::optional<int> resonator,
                  const std::string& placed, std::vector<Proposal>& out) {
  const auto gains = model.block(block).list(kShares);
  const auto unused = std::find(gains.begin(), gains.end(), 0.0);
  const ModePlace place{block, static_cast<std::size_t>(unused - gains.begin()), resonator};
  auto starts = mode_starts(scene);
  if (starts.empty()) return;
  Term term;
  term.placed = placed;
  term.blocks = {block};
  term.unknowns = {logarithmic_unknown("natural_frequency_hz", 0.3 * scene.low_hz, 3.0 * scene.top_hz),
                   logarithmic_unknown("damping_ratio", 1e-3, kMostDamping),
                   linear_unknown("gain", -INFINITY, INFINITY, 1.0)};
  term.write = [place](Model& m, std::span<const double> v) { place.write(m, v[0], v[1], v[2]); };
  out.push_back(propose_term(std::move(model), std::move(term), std::move(starts)));
}

bool parallel_mode_is_no_name(const Model&, const Term& term, const Scene& scene) {
  const double hz = term.unknowns[0].value;
  return hz > scene.top_hz || hz < scene.low_hz || !(term.unknowns[1].value < kMostDamping);
}

void add_block(const Scene& scene, std::size_t at, std::optional<int> resonator, const std::string& placed,
               std::vector<Proposal>& out) {
  Model model = *scene.model;
  const int block = model.insert(at, chain::make_block("parallel_modes"));
  if (resonator) ModePlace::set_resonator(model.block(block), model.block(*resonator));
  add_proposal(scene, std::move(model), block, resonator, placed, out);
}

void propose_parallel_mode(const Scene& scene, std::vector<Proposal>& out) {
  for (const Term& earlier : scene.model->terms()) {
    if (earlier.effect->name() != "parallel_mode") continue;
    const int block = earlier.blocks.front();
    add_proposal(scene, *scene.model, block, parallel_resonator(*scene.model, block), earlier.placed, out);
    return;
  }
  for (std::size_t at : scene.linear_places()) {
    const auto placed = scene.model->placed(at);
    add_block(scene, at, std::nullopt, placed, out);
  }
  for (std::size_t at : scene.base_places()) {
    if (is_linear_mode(scene, at))
      add_block(scene, at + 1, scene.model->id_at(at),
                "in parallel with block " + std::to_string(scene.model->base_number(at)), out);
  }
}

}  // namespace

BODESMITH_EFFECT(
    parallel_mode, .what = "a second-order mode in parallel with the path, of either sign",
    .experiment =
        "a sweep through the suspected frequency and the zero next to it, and the same with the sensor elsewhere",
    .linear = true, .told_as = "resonance", .repeatable = true, .of_no_circuit = true,
    .propose = propose_parallel_mode, .is_no_name = parallel_mode_is_no_name)

}  // namespace bodesmith::gap
