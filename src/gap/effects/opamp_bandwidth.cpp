#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

class OpampBandwidth final : public Effect {
 public:
  std::string_view name() const override { return "opamp_bandwidth"; }
  std::string_view what() const override { return "finite gain-bandwidth of a section's op-amp"; }
  std::string_view tell_tale() const override {
    return "gain and phase lost at the top of the band, more where the section's noise gain is large";
  }
  std::vector<std::string_view> confused_with() const override {
    return {"amplifier_pole", "time_delay", "capacitor_mismatch"};
  }
  std::string_view experiment() const override { return "the section alone, measured a decade higher"; }
  bool linear() const override { return true; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    for (std::size_t at = 0; at < scene.model->size(); ++at) {
      const auto& section = scene.model->at(at);
      if (!scene.model->is_base(at) || section.type_name() != "pole_zero") continue;
      bool free = false;
      for (const auto& p : section.parameters()) free = free || (p.free && p.key == "pole_hz");
      if (free) continue;
      Proposal p{*scene.model, {}};
      Term term;
      term.effect = this;
      term.placed = "inside block " + std::to_string(p.model.base_number(at));
      const int id = p.model.id_at(at);
      const double pole_hz = section.get("pole_hz");
      const int lag = p.model.insert(at + 1, chain::make_block("lowpass"));
      term.blocks = {lag};
      term.unknowns = {logarithmic_unknown("gain_bandwidth_hz", 0.5 * scene.band_hz, 1e4 * scene.band_hz)};
      for (double factor : {100.0, 20.0, 4.0}) p.starts.push_back({factor * scene.band_hz});
      term.unknowns[0].value = p.starts[0][0];
      term.write = [id, lag, pole_hz](Model& model, std::span<const double> v) {
        // Inverting section: H/(1 + (1 + H) s/w_t) with H = g (1 + s/z)/(1 + s/p); its two poles.
        const double g = std::abs(model.block(id).get("gain"));
        const double z = model.block(id).get("zero_hz");
        const double b = 1.0 / pole_hz + (1.0 + g) / v[0];
        const double a = (1.0 / pole_hz + g / z) / v[0];
        const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a));
        const double slow = 2.0 / (b + root);
        const double fast = 0.5 * (b + root) / a;
        // The pole nearer to the section's own stays with its zero.
        const bool own_is_slow = std::abs(std::log(slow / pole_hz)) <= std::abs(std::log(fast / pole_hz));
        model.block(id).set("pole_hz", own_is_slow ? slow : fast);
        model.block(lag).set("corner_hz", own_is_slow ? fast : slow);
      };
      term.undo = [id, pole_hz](Model& model) { model.block(id).set("pole_hz", pole_hz); };
      p.model.add(std::move(term));
      out.push_back(std::move(p));
    }
  }
};

}  // namespace

const Effect& opamp_bandwidth_effect() {
  static const OpampBandwidth effect;
  return effect;
}

}  // namespace bodesmith::gap
