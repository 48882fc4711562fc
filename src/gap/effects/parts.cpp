#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// A capacitor further off is another part.
constexpr double kMaxRatio = 1.5;

void propose_corners(const Scene& scene, std::size_t at, std::vector<Proposal>& out) {
  for (const auto& corner : scene.model->at(at).parameters()) {
    if (corner.free || !corner.spec->is_frequency() || !(corner.value > 0.0)) continue;
    const double value = corner.value;
    out.push_back(change_block(scene, at,
                               {logarithmic_unknown(corner.key(), value / kMaxRatio, value * kMaxRatio)},
                               {{value * 1.01}}));
  }
}

/// Of two poles, 1 + 2 zeta s/w + (s/w)^2, both capacitors make the last term and one of them the middle one as well (Tow and
/// Thomas; Sallen and Key; multiple feedback): r times that one makes w/sqrt(r) and zeta sqrt(r), r times the other one
/// w/sqrt(r) and zeta/sqrt(r). The gain at the poles stays.
void propose_pair(const Scene& scene, std::size_t at, bool damps, std::vector<Proposal>& out) {
  const chain::Block good = scene.model->at(at);
  for (const auto& p : good.parameters()) {
    if (p.free) return;
  }
  out.push_back(change_block(scene, at, {logarithmic_unknown("capacitor_ratio", 1.0 / kMaxRatio, kMaxRatio)},
                             {{1.01}}, [good, damps](chain::Block& section, std::span<const double> v) {
                               const double root = std::sqrt(v[0]);
                               const double damping = damps ? root : 1.0 / root;
                               section.set("natural_frequency_hz", good.get("natural_frequency_hz") / root)
                                   .set("damping_ratio", good.get("damping_ratio") * damping)
                                   .set("bandpass_gain", good.get("bandpass_gain") * damping);
                             }));
}

/// Each part of a block but op-amps.
void propose_parts(const Scene& scene, std::size_t at, std::vector<Proposal>& out) {
  const auto& parts = *scene.model->at(at).parts;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (parts[k].noise_gain.empty()) out.push_back(change_part(scene, at, k));
  }
}

/// Of blocks that are no sections.
void propose_part_value(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.base_places()) {
    const chain::Block& block = scene.model->at(at);
    if (block.parts && block.section_order() == 0) propose_parts(scene, at, out);
  }
}

void propose_capacitor_mismatch(const Scene& scene, std::vector<Proposal>& out) {
  for (std::size_t at : scene.base_places()) {
    const auto& section = scene.model->at(at);
    if (section.section_order() == 0) continue;
    if (section.parts) {
      propose_parts(scene, at, out);
    } else if (section.section_order() == 1) {
      propose_corners(scene, at, out);
    } else if (section.has("bandpass_gain")) {
      for (const bool damps : {false, true}) propose_pair(scene, at, damps, out);
    }
  }
}

}  // namespace

BODESMITH_EFFECT(part_value, .what = "a part of a block is off its value",
                 .experiment = "one end of the part lifted, and the part measured",
                 .propose = propose_part_value)

BODESMITH_EFFECT(capacitor_mismatch, .what = "a section's pole or zero is shifted by its capacitor ratio",
                 .experiment = "the section alone, measured across its corner", .linear = true,
                 .propose = propose_capacitor_mismatch)

}  // namespace bodesmith::gap
