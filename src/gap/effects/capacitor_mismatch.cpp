#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

class CapacitorMismatch final : public Effect {
 public:
  std::string_view name() const override { return "capacitor_mismatch"; }
  std::string_view what() const override {
    return "a section's pole or zero is shifted by its capacitor ratio";
  }
  std::string_view tell_tale() const override { return "a residual like the change of one corner frequency"; }
  std::vector<std::string_view> confused_with() const override { return {"opamp_bandwidth", "gain_error"}; }
  std::string_view experiment() const override { return "the section alone, measured across its corner"; }
  bool linear() const override { return true; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    for (std::size_t at = 0; at < scene.model->size(); ++at) {
      const auto& section = scene.model->at(at);
      if (!scene.model->is_base(at)) continue;
      if (section.type_name() != "pole_zero" && section.type_name() != "lowpass") continue;
      for (const auto& parameter : section.parameters()) {
        if (parameter.free || !parameter.spec->is_frequency() || !(parameter.value > 0.0)) continue;
        const double value = parameter.value;
        out.push_back(change_block(scene, *this, at,
                                   {logarithmic_unknown(parameter.key(), value / 1.5, value * 1.5)},
                                   {{value * 1.01}}));
      }
    }
  }
};

}  // namespace

const Effect& capacitor_mismatch_effect() {
  static const CapacitorMismatch effect;
  return effect;
}

}  // namespace bodesmith::gap
