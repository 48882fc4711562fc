#include <algorithm>
#include <cmath>

#include "chain/block.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

class SlewLimiter final : public MemoryKernel {
 public:
  SlewLimiter(double rate, double feedthrough) : rate_(rate), feedthrough_(feedthrough) {}
  double reset(double u, bool equilibrium) override {
    u_ = u;
    y_ = equilibrium ? u : 0.0;
    return output(u, y_);
  }
  double step(double u, double dt_s) override {
    y_ = follow(u, dt_s);
    u_ = u;
    return output(u, y_);
  }
  double peek(double u, double dt_s) const override { return output(u, follow(u, dt_s)); }
  bool rate_independent() const override { return false; }
  double slew_rate() const override { return rate_; }
  double slew_feedthrough() const override { return feedthrough_; }

 private:
  double output(double u, double y) const { return y + feedthrough_ * (u - y); }
  double follow(double u, double dt_s) const {
    // Exact for a straight input: first the output runs towards it at the limit; where they meet it follows,
    // or runs after it when the input itself is too fast.
    const double gap = u_ - y_;
    const double reach = rate_ * dt_s;
    const double move = u - u_;
    if (gap == 0.0) return y_ + std::clamp(move, -reach, reach);
    const double closing = gap > 0.0 ? reach - move : -reach - move;  // how far the gap closes over the step
    const double meets = gap / closing;                               // as a part of the step
    if (!(meets >= 0.0 && meets < 1.0)) return y_ + (gap > 0.0 ? reach : -reach);
    const double met = u_ + meets * move;
    const double left = (1.0 - meets) * reach;
    return met + std::clamp(u - met, -left, left);
  }
  double rate_;
  double feedthrough_;
  double u_ = 0.0;
  double y_ = 0.0;
};

/// x = u, or x' = rate_per_s sign(u - x) while u runs away: |x'| <= rate_per_s; y = x + feedthrough (u - x): the part of an
/// input edge that reaches the output at once, as through the feedback network of a slewing op-amp.
class SlewLimit final : public BlockType {
 public:
  SlewLimit()
      : BlockType(
            "slew_limit", "limits the rate of change",
            {above_zero("rate_per_s", "y/s", "fastest change a second"),
             not_negative("feedthrough", "1", "part of the input that passes at once").with_default(0.0)}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<SlewLimiter>(block.get("rate_per_s"), block.get("feedthrough"));
  }
  /// Itself where the limit allows it; a straight line at the limit from where it does not.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    FoundInput out{wanted.values, {}};
    const double reach = block.get("rate_per_s") * wanted.step_s;
    for (std::size_t i = 1; i < out.values.size(); ++i) {
      const double before = out.values[i - 1];
      out.values[i] = std::clamp(wanted.values[i], before - reach, before + reach);
      if (std::abs(out.values[i] - wanted.values[i]) > 1e-9 * (std::abs(wanted.values[i]) + reach))
        out.out_of_reach.push_back(i);
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, slew_limit_block, SlewLimit)

}  // namespace bodesmith::chain
