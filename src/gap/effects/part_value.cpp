#include <algorithm>

#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Of a part's value: less is a short or another decade, and no longer a value.
constexpr double kMostPercent = 60.0;
/// An offset is looked for within so many tolerances.
constexpr double kMostTolerances = 30.0;

class PartValue final : public Effect {
 public:
  std::string_view name() const override { return "part_value"; }
  std::string_view what() const override { return "a part of a block is off its value"; }
  std::vector<std::string_view> confused_with() const override {
    return {"multiplier_error", "quadratic_nonlinearity", "cubic_nonlinearity", "asymmetric_hysteresis"};
  }
  std::string_view experiment() const override { return "one end of the part lifted, and the part measured"; }
  int places_a_round() const override { return 6; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : scene.base_places()) {
      const auto& parts = scene.model->at(at).parts;
      for (std::size_t k = 0; parts && k < parts->size(); ++k) out.push_back(with_part(scene, at, k));
    }
  }

 private:
  Proposal with_part(const Scene& scene, std::size_t at, std::size_t which) const {
    const int id = scene.model->id_at(at);
    const chain::Block good = scene.model->at(at);
    const chain::PartChange part = (*good.parts)[which];
    const bool volts = part.unit == "v";
    const double most = volts ? kMostTolerances * part.tolerance : kMostPercent;
    const double start = volts ? part.tolerance : 2.0;
    Term term;
    term.effect = this;
    term.placed = part.part + " inside block " + std::to_string(scene.model->base_number(at));
    term.part = part.part;
    term.unknowns = {linear_unknown(volts ? "off_v" : "off_percent", -most, most, start)};
    term.write = [id, good, part](Model& m, std::span<const double> v) {
      m.block(id) = good.with(part, v[0]);
    };
    term.undo = [id, good](Model& m) { m.block(id) = good; };
    return propose_term(*scene.model, std::move(term), {{start}});
  }
};

}  // namespace

const Effect& part_value_effect() {
  static const PartValue effect;
  return effect;
}

}  // namespace bodesmith::gap
