#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

/// Samples of a short record.
constexpr std::size_t kShort = 5000;

class Hysteresis final : public Effect {
 public:
  std::string_view name() const override { return "hysteresis"; }
  std::string_view what() const override { return "rate-independent memory"; }
  std::string_view tell_tale() const override {
    return "a residual that changes sign with the direction of motion and grows with amplitude";
  }
  std::vector<std::string_view> confused_with() const override {
    return {"backlash", "creep", "time_delay", "rate_dependence"};
  }
  std::string_view experiment() const override {
    return "loops of several amplitudes at two frequencies: memory keeps its loop when the frequency changes";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    // A bank of plays with fixed radii (Prandtl-Ishlinskii): linear in its weights, dense enough for any
    // smooth loop.
    for (std::size_t at : scene.static_places()) {
      const double half = 0.5 * scene.boundary[at].span();
      if (!(half > 0.0)) continue;
      const std::vector<double> parts = {0.02, 0.06, 0.12, 0.2, 0.3, 0.42, 0.56, 0.72, 0.88};
      std::vector<double> radius = {0.0};
      std::vector<double> weight = {1.0};
      std::vector<Unknown> unknowns;
      std::vector<double> start;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        radius.push_back(parts[k] * half);
        weight.push_back(0.01);
        unknowns.push_back(linear_unknown("w[" + std::to_string(k + 1) + "]", 0.0, 5.0, 0.05));
        start.push_back(0.01);
      }
      auto block = chain::make_block("prandtl_ishlinskii");
      block.set("r", radius).set("w", weight);
      out.push_back(insert_block(scene, *this, at, block, unknowns, {start}));
      propose_bouc_wen(scene, at, half, out);
    }
  }

 private:
  /// y = u - z with gamma as a share of beta: a smooth loop that the plays only follow in corners.
  void propose_bouc_wen(const Scene& scene, std::size_t at, double half, std::vector<Proposal>& out) const {
    Proposal p{*scene.model, {}};
    Term term;
    term.effect = this;
    term.placed = p.model.placed(at);
    auto block = chain::make_block("bouc_wen").set("k", 1.0).set("A", 0.1).set("beta", 1.0).set("gamma", 0.0);
    const int id = p.model.insert(at, std::move(block));
    term.blocks = {id};
    term.unknowns = {linear_unknown("A", -3.0, 0.9, 0.1),
                     logarithmic_unknown("beta", 0.02 / half, 20.0 / half),
                     linear_unknown("gamma_over_beta", -0.9, 1.0, 0.2), linear_unknown("n", 1.0, 2.0, 0.3)};
    // Another sharpness than 1 has no closed form and costs ten times as much: for short records only.
    const bool sharpness = scene.residual.size() <= kShort;
    if (!sharpness) term.unknowns.pop_back();
    for (double a : {0.1, -0.1}) {
      for (double beta : {1.0 / half, 5.0 / half}) {
        p.starts.push_back({a, beta, 0.0});
        if (sharpness) p.starts.back().push_back(1.1);
      }
    }
    for (std::size_t k = 0; k < term.unknowns.size(); ++k) term.unknowns[k].value = p.starts[0][k];
    term.write = [id](Model& model, std::span<const double> v) {
      model.block(id)
          .set("A", v[0])
          .set("beta", v[1])
          .set("gamma", v[2] * v[1])
          .set("n", v.size() > 3 ? v[3] : 1.0);
    };
    p.model.add(std::move(term));
    out.push_back(std::move(p));
  }
};

}  // namespace

const Effect& hysteresis_effect() {
  static const Hysteresis effect;
  return effect;
}

}  // namespace bodesmith::gap
