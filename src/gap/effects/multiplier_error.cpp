#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effects/list.hpp"

namespace bodesmith::gap {
namespace {

class MultiplierError final : public Effect {
 public:
  std::string_view name() const override { return "multiplier_error"; }
  std::string_view what() const override {
    return "scale, feedthrough or offset of a multiplier in the chain";
  }
  std::string_view tell_tale() const override {
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
    for (std::size_t at = 0; at < scene.model->size(); ++at) {
      const auto& block = scene.model->at(at);
      if (!scene.model->is_base(at)) continue;
      if (block.type_name() == "polynomial_hysteresis") {
        for (const auto& p : block.parameters()) {
          if (p.free) return;
        }
        propose_in(scene, at, {"ascending", "descending"}, 0, out);
      } else if (block.type_name() == "multiplier") {
        propose_in_multiplier(scene, at, out);
      } else if (block.type_name() == "polynomial" && block.list("coefficients").size() > 2) {
        propose_in(scene, at, {"coefficients"}, 1, out);
      }
    }
  }

 private:
  static constexpr unsigned kScale = 1;
  static constexpr unsigned kFeedthrough = 2;
  static constexpr unsigned kOffset = 4;

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

  /// Powers by multipliers of output scale (x + feedthrough) y: x, m(x,x), m(m(x,x),x). A coefficient of x^n
  /// then leaks into that of x^(n-1). `zero_power`: index of x^1 in the lists. The offset stands behind the
  /// sum.
  void propose_in(const Scene& scene, std::size_t at, std::vector<std::string> lists, std::size_t first,
                  std::vector<Proposal>& out) const {
    const double size = scene.boundary[at].size();
    // Each alone, and all together.
    for (const unsigned which : {kScale, kFeedthrough, kOffset, kScale | kFeedthrough | kOffset}) {
      Proposal p{*scene.model, {}};
      Term term;
      term.effect = this;
      const int id = p.model.id_at(at);
      std::vector<std::vector<double>> before;
      for (const auto& list : lists) before.push_back(p.model.at(at).list(list));
      term.placed = "inside block " + std::to_string(p.model.base_number(at));
      std::vector<double> start;
      if ((which & kScale) != 0) {
        term.unknowns.push_back(linear_unknown("scale", 0.5, 2.0, 0.05));
        start.push_back(1.02);
      }
      if ((which & kFeedthrough) != 0) {
        term.unknowns.push_back(linear_unknown("feedthrough", -size, size, 0.05 * size));
        start.push_back(0.005 * size);
      }
      int offset = -1;
      if ((which & kOffset) != 0) {
        term.unknowns.push_back(linear_unknown("offset", -size, size, 0.05 * size));
        start.push_back(0.005 * size);
        offset = p.model.insert(at + 1, chain::make_block("gain").set("gain", 1.0));
        term.blocks = {offset};
      }
      p.starts = {start};
      term.write = [=](Model& model, std::span<const double> v) {
        std::size_t next = 0;
        const double scale = (which & kScale) != 0 ? v[next++] : 1.0;
        const double feed = (which & kFeedthrough) != 0 ? v[next++] : 0.0;
        for (std::size_t k = 0; k < lists.size(); ++k) {
          auto a = before[k];
          double factor = 1.0;
          for (std::size_t n = first + 1; n < a.size(); ++n) {
            factor *= scale;
            a[n] = factor * before[k][n];
            a[n - 1] += factor * feed * before[k][n];
          }
          model.block(id).set(lists[k], a);
        }
        if (offset >= 0) model.block(offset).set("offset", v[next]);
      };
      term.undo = [=](Model& model) {
        for (std::size_t k = 0; k < lists.size(); ++k) model.block(id).set(lists[k], before[k]);
      };
      for (std::size_t k = 0; k < term.unknowns.size(); ++k) term.unknowns[k].value = p.starts[0][k];
      p.model.add(std::move(term));
      out.push_back(std::move(p));
    }
  }
};

}  // namespace

const Effect& multiplier_error_effect() {
  static const MultiplierError effect;
  return effect;
}

}  // namespace bodesmith::gap
