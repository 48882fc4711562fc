#include <algorithm>
#include <string>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Which of a multiplier's errors a term holds.
struct MultiplierErrors {
  bool scale = false;
  bool feedthrough = false;
  bool offset = false;
};

/// Powers made by multipliers of output scale (x + feedthrough) y: x, m(x,x), m(m(x,x),x). A coefficient of
/// x^n then leaks into that of x^(n-1). `first`: place of the coefficient of x^1.
std::vector<double> with_errors(const std::vector<double>& coefficients, std::size_t first, double scale,
                                double feedthrough) {
  auto a = coefficients;
  double factor = 1.0;
  for (std::size_t n = first + 1; n < a.size(); ++n) {
    factor *= scale;
    a[n] = factor * coefficients[n];
    a[n - 1] += factor * feedthrough * coefficients[n];
  }
  return a;
}

class MultiplierError final : public Effect {
 public:
  std::string_view name() const override { return "multiplier_error"; }
  std::string_view what() const override {
    return "scale, feedthrough or offset of a multiplier in the chain";
  }
  std::string_view symptom() const override {
    return "a residual like the powers that multipliers make, on both branches alike";
  }
  std::vector<std::string_view> confused_with() const override {
    return {"gain_error", "quadratic_nonlinearity", "offset"};
  }
  std::string_view experiment() const override {
    return "the disturbance generator alone, swept from end to end";
  }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    if (scene.frequency_only) return;
    for (std::size_t at : scene.base_places()) {
      const auto& block = scene.model->at(at);
      if (block.has("scale_v")) propose_in_multiplier(scene, at, out);
      const auto powers = block.polynomials();
      const bool bends = std::any_of(powers.begin(), powers.end(), [&](const chain::PolynomialList& list) {
        return block.list(list.key).size() > list.first + 1;
      });
      const bool refitted = std::any_of(block.parameters().begin(), block.parameters().end(),
                                        [](const chain::Parameter& p) { return p.free; });
      if (!bends || refitted) continue;
      // Each alone, and all together.
      for (const MultiplierErrors which :
           {MultiplierErrors{.scale = true}, MultiplierErrors{.feedthrough = true},
            MultiplierErrors{.offset = true}, MultiplierErrors{true, true, true}}) {
        out.push_back(in_powers(scene, at, powers, which));
      }
    }
  }

 private:
  void propose_in_multiplier(const Scene& scene, std::size_t at, std::vector<Proposal>& out) const {
    const double size = scene.boundary[at].size();
    const auto& block = scene.model->at(at);
    const double scale = block.get("scale_v");
    const auto scale_v = linear_unknown("scale_v", 0.5 * scale, 2.0 * scale, 0.05 * scale);
    const auto feedthrough = linear_unknown("feedthrough", -1.0, 1.0, 0.05);
    const auto z_offset =
        linear_unknown("z_offset_v", -size * size / scale, size * size / scale, 0.05 * size * size / scale);
    const double part = 0.01 * size * size / scale;
    out.push_back(change_block(scene, *this, at, {scale_v}, {{1.02 * scale}}));
    out.push_back(change_block(scene, *this, at, {feedthrough}, {{0.01}}));
    out.push_back(change_block(scene, *this, at, {z_offset}, {{part}}));
    out.push_back(
        change_block(scene, *this, at, {scale_v, feedthrough, z_offset}, {{1.02 * scale, 0.01, part}}));
  }

  /// Of the multipliers that make a block's powers; an offset stands behind their sum.
  Proposal in_powers(const Scene& scene, std::size_t at, const std::vector<chain::PolynomialList>& powers,
                     MultiplierErrors which) const {
    const double size = scene.boundary[at].size();
    Model model = *scene.model;
    const int id = model.id_at(at);
    std::vector<std::vector<double>> before;
    for (const auto& list : powers) before.push_back(model.at(at).list(list.key));
    Term term;
    term.effect = this;
    term.placed = inside_block(model, at);
    std::vector<double> start;
    if (which.scale) {
      term.unknowns.push_back(linear_unknown("scale", 0.5, 2.0, 0.05));
      start.push_back(1.02);
    }
    if (which.feedthrough) {
      term.unknowns.push_back(linear_unknown("feedthrough", -size, size, 0.05 * size));
      start.push_back(0.005 * size);
    }
    int offset_id = 0;
    if (which.offset) {
      term.unknowns.push_back(linear_unknown("offset", -size, size, 0.05 * size));
      start.push_back(0.005 * size);
      offset_id = model.insert(at + 1, chain::make_block("gain").set("gain", 1.0));
      term.blocks = {offset_id};
    }
    term.write = [=](Model& m, std::span<const double> v) {
      std::size_t next = 0;
      const double scale = which.scale ? v[next++] : 1.0;
      const double feedthrough = which.feedthrough ? v[next++] : 0.0;
      for (std::size_t k = 0; k < powers.size(); ++k)
        m.block(id).set(powers[k].key, with_errors(before[k], powers[k].first, scale, feedthrough));
      if (which.offset) m.block(offset_id).set("offset", v[next]);
    };
    term.undo = [=](Model& m) {
      for (std::size_t k = 0; k < powers.size(); ++k) m.block(id).set(powers[k].key, before[k]);
    };
    return propose_term(std::move(model), std::move(term), {start});
  }
};

}  // namespace

const Effect& multiplier_error_effect() {
  static const MultiplierError effect;
  return effect;
}

}  // namespace bodesmith::gap
