#include <cmath>

#include "schematic/elements/element.hpp"

namespace bodesmith::schematic {
namespace {

/// V(out) = .5 + .5 tanh(gain (V(in) - threshold)), an ideal source.
class ComparatorElement final : public Element {
 public:
  ComparatorElement(int in, int out, int branch, double gain, double threshold_v)
      : in_(in), out_(out), branch_(branch), gain_(gain), threshold_v_(threshold_v) {}
  void stamp(const Point& at, Stamps& to) const override {
    const double level = std::tanh(gain_ * (at[in_] - threshold_v_));
    to.add(out_, -at[branch_], 0.0);
    to.slope(out_, branch_, -1.0, 0.0);
    to.add(branch_, at[out_] - 0.5 - 0.5 * level, 0.0);
    to.slope(branch_, out_, 1.0, 0.0);
    to.slope(branch_, in_, -0.5 * gain_ * (1.0 - level * level), 0.0);
  }

 private:
  int in_, out_, branch_;
  double gain_, threshold_v_;
};

/// V(out) = product of V(high) and 1 - V(low), an ideal source.
class GateElement final : public Element {
 public:
  GateElement(std::vector<int> high, std::vector<int> low, int out, int branch)
      : high_(std::move(high)), low_(std::move(low)), out_(out), branch_(branch) {}
  void stamp(const Point& at, Stamps& to) const override {
    to.add(out_, -at[branch_], 0.0);
    to.slope(out_, branch_, -1.0, 0.0);
    to.add(branch_, at[out_] - product(at, kInput - 1), 0.0);
    to.slope(branch_, out_, 1.0, 0.0);
    for (const int one : high_) to.slope(branch_, one, -product(at, one), 0.0);
    for (const int one : low_) to.slope(branch_, one, product(at, one), 0.0);
  }

 private:
  /// Of all levels but one.
  double product(const Point& at, int but) const {
    double out = 1.0;
    for (const int one : high_) out *= one == but ? 1.0 : at[one];
    for (const int one : low_) out *= one == but ? 1.0 : 1.0 - at[one];
    return out;
  }
  std::vector<int> high_, low_;
  int out_, branch_;
};

}  // namespace

std::unique_ptr<Element> make_comparator(int in, int out, int branch, double gain, double threshold_v) {
  return std::make_unique<ComparatorElement>(in, out, branch, gain, threshold_v);
}

std::unique_ptr<Element> make_gate(std::vector<int> high, std::vector<int> low, int out, int branch) {
  return std::make_unique<GateElement>(std::move(high), std::move(low), out, branch);
}

}  // namespace bodesmith::schematic
