#include <algorithm>
#include <cmath>

#include "chain/block.hpp"
#include "chain/inverse.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// One integrator with a limited rate and rails that act ON it (a clamp behind it would let it wind up).
class OpampKernel final : public OdeKernel {
 public:
  explicit OpampKernel(const Block& block)
      : rate_(block.get("slew_rate_v_per_s")),
        open_(Hertz{block.get("gain_bandwidth_hz")}.rad_s().value),
        gain_(block.get("gain")),
        low_(std::min(block.get("lower_rail_v"), block.get("upper_rail_v"))),
        high_(std::max(block.get("lower_rail_v"), block.get("upper_rail_v"))),
        clamp_(30.0 * open_ / gain_) {
    linear_ = pole_zero_kernel(gain_, INFINITY, open_ / gain_);
    // pole_zero_kernel's state is the output over the gain.
    entry_ = {1.0 / gain_};
  }
  const StateSpace& linear() const override { return linear_; }
  const std::vector<double>& entry() const override { return entry_; }
  double nonlinear(const double* x, double u) const override {
    const double y = gain_ * x[0];
    const double free = open_ * (u - x[0]);
    return rate_ * std::tanh(free / rate_) - free - clamp_ * (y - std::clamp(y, low_, high_));
  }
  double nonlinear_gradient(const double* x, double u, double* by_x) const override {
    const double y = gain_ * x[0];
    const double t = std::tanh(open_ * (u - x[0]) / rate_);
    const double by_u = -open_ * t * t;  // open (1 - t^2) - open
    by_x[0] = -by_u - (y < low_ || y > high_ ? clamp_ * gain_ : 0.0);
    return by_u;
  }
  void equilibrium(double u, double* x) const override {
    // Where tanh and clamp balance; inside the rails that is x = u.
    const double y = gain_ * u;
    x[0] = u;
    if (y >= low_ && y <= high_) return;
    const double rail = std::clamp(y, low_, high_);
    double inside = rail;
    double outside = y;
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (inside + outside);
      const double state = middle / gain_;
      const double push = open_ * (u - state) + nonlinear(&state, u);
      const bool beyond = push * (y - rail) < 0.0;
      (beyond ? outside : inside) = middle;
    }
    x[0] = 0.5 * (inside + outside) / gain_;
  }

 private:
  double rate_;
  double open_;
  double gain_;
  double low_;
  double high_;
  double clamp_;
  StateSpace linear_;
  std::vector<double> entry_;
};

/// An op-amp in a non-inverting stage of the given gain G:
///   y' = SR tanh(2 pi GBW (u - y/G)/SR), held between the rails (a clamp of 30 times the closed-loop
///   bandwidth on y itself).
/// Small signals see G/(1 + s G/(2 pi GBW)).
class Opamp final : public BlockType {
 public:
  Opamp()
      : BlockType("opamp", "op-amp stage with gain-bandwidth, slew rate and rails",
                  {at_least("gain", "1", "closed-loop gain, at least 1", 1.0).with_default(1.0),
                   above_zero("gain_bandwidth_hz", "Hz", "gain-bandwidth product"),
                   above_zero("slew_rate_v_per_s", "V/s", "fastest change of the output"),
                   any_number("lower_rail_v", "V", "lowest output").with_default(-1e6),
                   any_number("upper_rail_v", "V", "highest output").with_default(1e6)}) {}
  std::string validate(const Block& block) const override {
    return block.get("lower_rail_v") < block.get("upper_rail_v") ? ""
                                                                 : "lower_rail_v is not below upper_rail_v";
  }
  Kernel kernel(const Block& block) const override { return std::make_unique<OpampKernel>(block); }
  /// Of the linear part; beyond the rails there is nothing.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    const auto [low, high] = std::minmax({block.get("lower_rail_v"), block.get("upper_rail_v")});
    WantedOutput inside = wanted;
    std::vector<std::size_t> beyond;
    for (std::size_t i = 0; i < inside.values.size(); ++i) {
      inside.values[i] = std::clamp(wanted.values[i], low, high);
      if (inside.values[i] != wanted.values[i]) beyond.push_back(i);
    }
    LinearKernel linear;
    static_cast<StateSpace&>(linear) = OpampKernel(block).linear();
    FoundInput out = inverse_of(linear, inside);
    out.out_of_reach = std::move(beyond);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, opamp_block, Opamp)

}  // namespace bodesmith::chain
