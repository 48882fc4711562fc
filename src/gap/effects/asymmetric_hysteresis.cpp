#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

class AsymmetricHysteresis final : public Effect {
 public:
  std::string_view name() const override { return "asymmetric_hysteresis"; }
  std::string_view what() const override { return "memory whose ascending and descending branches differ"; }
  std::string_view tell_tale() const override {
    return "a residual that changes sign with the direction of motion, with even harmonics";
  }
  std::vector<std::string_view> confused_with() const override {
    return {"hysteresis", "quadratic_nonlinearity", "cubic_nonlinearity"};
  }
  std::string_view experiment() const override { return "loops of several amplitudes about several biases"; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : scene.static_places()) {
      const auto& signal = scene.boundary[at];
      const double half = 0.5 * signal.span();
      if (!(half > 0.0)) continue;
      // Branch polynomials (first seed, eq. 1). With a free gain in the chain their common slope would be
      // counted twice.
      {
        bool free_gain = false;
        for (const auto& u : scene.model->unknowns()) free_gain = free_gain || u.name.ends_with("gain");
        Proposal p{*scene.model, {}};
        Term term;
        term.effect = this;
        term.placed = p.model.placed(at);
        const int id = p.model.insert(at, chain::make_block("polynomial_hysteresis")
                                              .set("ascending", std::vector<double>{0.0, 0.0, 0.0})
                                              .set("descending", std::vector<double>{0.0, 0.0, 0.0}));
        term.blocks = {id};
        std::vector<double> start;
        for (const char* branch : {"ascending", "descending"}) {
          double scale = 0.1;
          for (int k = 0; k < 3; ++k) {
            if (!(free_gain && k == 0 && branch[0] == 'd')) {
              term.unknowns.push_back(linear_unknown(std::string(branch) + "[" + std::to_string(k) + "]",
                                                     -20.0 * scale, 20.0 * scale, scale));
              term.unknowns.back().value = 0.01 * scale;
              start.push_back(0.01 * scale);
            }
            scale /= signal.size();
          }
        }
        p.starts = {start};
        term.write = [id, free_gain](Model& model, std::span<const double> v) {
          const std::vector<double> up(v.begin(), v.begin() + 3);
          std::vector<double> down(v.begin() + 3, v.end());
          if (free_gain) down.insert(down.begin(), -v[0]);
          model.block(id).set("ascending", up).set("descending", down);
        };
        p.model.add(std::move(term));
        out.push_back(std::move(p));
      }
      // Plays followed by one-sided dead zones (Kuhnen 2003).
      {
        const std::vector<double> parts = {0.04, 0.12, 0.25, 0.42, 0.62, 0.82};
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
        std::vector<double> threshold;
        std::vector<double> slope;
        for (double part : {0.1, 0.4, 0.7, 0.9}) {
          double s = signal.low + part * signal.span();
          if (std::abs(s) < 1e-3 * half) s = 1e-3 * half;
          threshold.push_back(s);
          unknowns.push_back(linear_unknown("v[" + std::to_string(slope.size()) + "]", -0.9, 5.0, 0.05));
          slope.push_back(0.01);
          start.push_back(0.01);
        }
        auto block = chain::make_block("prandtl_ishlinskii");
        block.set("r", radius).set("w", weight).set("s", threshold).set("v", slope);
        out.push_back(insert_block(scene, *this, at, block, unknowns, {start}));
      }
    }
  }
};

}  // namespace

const Effect& asymmetric_hysteresis_effect() {
  static const AsymmetricHysteresis effect;
  return effect;
}

}  // namespace bodesmith::gap
