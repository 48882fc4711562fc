#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A section g (1 + s/z)/(1 + s/p) of the chain, and what stands behind it: a resonator with the two new poles, and a pole_zero
/// whose zero cancels the section's own one. The section stays as it is, so that its capacitors can be off besides.
struct SlowSection {
  int id;
  int poles;
  int instead;
};

/// The pole behind the cancelling zero lies this many times beyond the new ones, where it does nothing.
constexpr double kOutOfTheWay = 1e4;

/// H/(1 + N s/w_t), H = g (1 + s/z)/(1 + s/p), noise gain N = 1 + H when inverting, H when not: its zero
/// stays, its two poles, real or complex, are those of 1 + b s + a s^2 in hertz.
void write_two_poles(Model& model, const SlowSection& section, double gain_bandwidth_hz, bool inverting) {
  const double g = std::abs(model.block(section.id).get("gain"));
  const double z = model.block(section.id).get("zero_hz");
  const double p = model.block(section.id).get("pole_hz");
  const double b = 1.0 / p + (inverting ? 1.0 + g : g) / gain_bandwidth_hz;
  const double a = ((inverting ? 1.0 / p : 0.0) + g / z) / gain_bandwidth_hz;
  const double natural_hz = 1.0 / std::sqrt(a);
  model.block(section.instead).set("zero_hz", p).set("pole_hz", kOutOfTheWay * std::max(natural_hz, b / a));
  model.block(section.poles)
      .set("natural_frequency_hz", natural_hz)
      .set("damping_ratio", 0.5 * b * natural_hz);
}

class OpampBandwidth final : public Effect {
 public:
  OpampBandwidth()
      : Effect({.name = "opamp_bandwidth",
                .what = "finite gain-bandwidth of a section's op-amp",
                .experiment = "the section alone, measured a decade higher",
                .linear = true}) {}
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    std::vector<std::size_t> sections;
    for (std::size_t at : scene.base_places()) {
      const auto& section = scene.model->at(at);
      if (!section.has("pole_hz") || !section.has("zero_hz")) continue;
      const bool free = std::any_of(section.parameters().begin(), section.parameters().end(),
                                    [](const chain::Parameter& p) { return p.free && p.key() == "pole_hz"; });
      if (!free) sections.push_back(at);
    }
    for (const bool inverting : {true, false}) {
      for (std::size_t at : sections) out.push_back(in_sections(scene, {at}, inverting));
      // Boards carry one type of op-amp.
      if (sections.size() > 1) out.push_back(in_sections(scene, sections, inverting));
    }
  }

 private:
  Proposal in_sections(const Scene& scene, const std::vector<std::size_t>& sections, bool inverting) const {
    Model model = *scene.model;
    Term term;
    term.effect = this;
    std::vector<SlowSection> found;
    // From behind, so that the places in front stay where they are.
    for (auto at = sections.rbegin(); at != sections.rend(); ++at) {
      const int poles = model.insert(*at + 1, chain::make_block("resonator"));
      const int instead = model.insert(*at + 2, chain::make_block("pole_zero"));
      found.push_back({model.id_at(*at), poles, instead});
      term.blocks.insert(term.blocks.end(), {poles, instead});
    }
    std::vector<std::string> numbers;
    std::vector<std::string> parts;
    for (std::size_t at : sections) {
      numbers.push_back(std::to_string(scene.model->base_number(at)));
      if (const auto& part = scene.model->at(at).part; !part.empty()) parts.push_back(part);
    }
    term.part = join(parts, ", ");
    term.placed = (numbers.size() > 1 ? "inside blocks " : "inside block ") + join(numbers, ", ");
    term.unknowns = {logarithmic_unknown("gain_bandwidth_hz", 0.5 * scene.band_hz, 1e4 * scene.band_hz)};
    Starts starts;
    for (double factor : {100.0, 20.0, 4.0}) starts.push_back({factor * scene.band_hz});
    term.write = [found, inverting](Model& m, std::span<const double> v) {
      for (const auto& section : found) write_two_poles(m, section, v[0], inverting);
    };
    term.reads_base_blocks = true;
    // It belongs inside its section, and taking its blocks out is all there is to undo.
    term.undo = [](Model&) {};
    return propose_term(std::move(model), std::move(term), std::move(starts));
  }
};

}  // namespace

BODESMITH_ENTRY(Effect, opamp_bandwidth_effect, OpampBandwidth)

}  // namespace bodesmith::gap
