#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

class PartValue final : public Effect {
 public:
  PartValue()
      : Effect({.name = "part_value",
                .what = "a part of a block is off its value",
                .experiment = "one end of the part lifted, and the part measured",
                .places_a_round = 6}) {}
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
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
    const double most = part.most();
    const double start = part.is_offset() ? part.tolerance : 2.0;
    Term term;
    term.effect = this;
    term.placed = part.part + " inside block " + std::to_string(scene.model->base_number(at));
    term.part = part.part;
    term.unknowns = {linear_unknown(part.is_offset() ? "off_v" : "off_percent", -most, most, start)};
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
