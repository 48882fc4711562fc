#include <cmath>

#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// W + (1/bandwidth) dW/dt = (X + x)(Y + y)/(U (1 + scale)) (1 + bend) + Z + w, an ideal source at its output.
class MultiplierElement final : public Element {
 public:
  MultiplierElement(const Factors& at, int branch, const MultiplierModel& model,
                    const MultiplierDeviation& off)
      : at_(at), branch_(branch), model_(model), off_(off) {}

  void stamp(const Point& p, Stamps& to) const override {
    to.add(at_.out, -p[branch_], 0.0);
    to.slope(at_.out, branch_, -1.0, 0.0);
    const double u = model_.scale_v, lag = 1.0 / model_.bandwidth.rad_s().value;
    to.add(branch_, off_.product(u, p[at_.x], p[at_.y]) + p[at_.z] + off_.w - p[at_.out], -lag * p[at_.out]);
    const double scale = (1.0 + off_.bend) / (u * (1.0 + off_.scale));
    to.slope(branch_, at_.x, scale * (p[at_.y] + off_.y), 0.0);
    to.slope(branch_, at_.y, scale * (p[at_.x] + off_.x), 0.0);
    to.slope(branch_, at_.z, 1.0, 0.0);
    to.slope(branch_, at_.out, -1.0, -lag);
  }
  void noise(RadPerSecond, bool, NoiseSources& to) const override {
    to.add(branch_, kGround, std::pow(model_.noise_v_per_rthz, 2));
  }

 private:
  Factors at_;
  int branch_;
  MultiplierModel model_;
  MultiplierDeviation off_;
};

}  // namespace

std::unique_ptr<Element> make_multiplier(const Factors& at, int branch, const MultiplierModel& model,
                                         const MultiplierDeviation& off) {
  return std::make_unique<MultiplierElement>(at, branch, model, off);
}

}  // namespace bodesmith::schematic
