#include <algorithm>
#include <cmath>

#include "base/text.hpp"
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
    std::vector<std::size_t> sections;
    for (std::size_t at = 0; at < scene.model->size(); ++at) {
      const auto& section = scene.model->at(at);
      if (!scene.model->is_base(at) || section.type_name() != "pole_zero") continue;
      bool free = false;
      for (const auto& p : section.parameters()) free = free || (p.free && p.key() == "pole_hz");
      if (!free) sections.push_back(at);
    }
    for (const bool inverting : {true, false}) {
      for (std::size_t at : sections) propose_in(scene, {at}, inverting, out);
      // Boards carry one type of op-amp.
      if (sections.size() > 1) propose_in(scene, sections, inverting, out);
    }
  }

 private:
  void propose_in(const Scene& scene, const std::vector<std::size_t>& sections, bool inverting,
                  std::vector<Proposal>& out) const {
    struct Section {
      int id;
      int lag;
      double pole_hz;
    };
    Proposal p{*scene.model, {}};
    Term term;
    term.effect = this;
    std::vector<Section> found;
    // From behind, so that the places in front stay where they are.
    for (auto at = sections.rbegin(); at != sections.rend(); ++at) {
      const int lag = p.model.insert(*at + 1, chain::make_block("lowpass"));
      found.push_back({p.model.id_at(*at), lag, p.model.at(*at).get("pole_hz")});
      term.blocks.push_back(lag);
    }
    std::vector<std::string> numbers;
    for (std::size_t at : sections) numbers.push_back(std::to_string(scene.model->base_number(at)));
    term.placed = (numbers.size() > 1 ? "inside blocks " : "inside block ") + join(numbers, ", ");
    term.unknowns = {logarithmic_unknown("gain_bandwidth_hz", 0.5 * scene.band_hz, 1e4 * scene.band_hz)};
    for (double factor : {100.0, 20.0, 4.0}) p.starts.push_back({factor * scene.band_hz});
    term.unknowns[0].value = p.starts[0][0];
    term.write = [found, inverting](Model& model, std::span<const double> v) {
      // H/(1 + N s/w_t), H = g (1 + s/z)/(1 + s/p), noise gain N = 1 + H inverting, H otherwise; its two
      // poles.
      for (const auto& section : found) {
        const double g = std::abs(model.block(section.id).get("gain"));
        const double z = model.block(section.id).get("zero_hz");
        const double b = 1.0 / section.pole_hz + (inverting ? 1.0 + g : g) / v[0];
        const double a = ((inverting ? 1.0 / section.pole_hz : 0.0) + g / z) / v[0];
        const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a));
        const double slow = 2.0 / (b + root);
        const double fast = 0.5 * (b + root) / a;
        // The pole nearer to the section's own stays with its zero.
        const bool own_is_slow =
            std::abs(std::log(slow / section.pole_hz)) <= std::abs(std::log(fast / section.pole_hz));
        model.block(section.id).set("pole_hz", own_is_slow ? slow : fast);
        model.block(section.lag).set("corner_hz", own_is_slow ? fast : slow);
      }
    };
    term.undo = [found](Model& model) {
      for (const auto& section : found) model.block(section.id).set("pole_hz", section.pole_hz);
    };
    p.model.add(std::move(term));
    out.push_back(std::move(p));
  }
};

}  // namespace

const Effect& opamp_bandwidth_effect() {
  static const OpampBandwidth effect;
  return effect;
}

}  // namespace bodesmith::gap
