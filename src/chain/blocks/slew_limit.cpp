#include <algorithm>
#include <cmath>

#include "chain/blocks/block_list.hpp"

namespace bodesmith::chain {
namespace {

class SlewLimiter final : public MemoryKernel {
 public:
  explicit SlewLimiter(double rate) : rate_(rate) {}
  std::unique_ptr<MemoryKernel> clone() const override { return std::make_unique<SlewLimiter>(*this); }
  double reset(double u, bool equilibrium) override {
    u_ = u;
    return y_ = equilibrium ? u : 0.0;
  }
  double step(double u, double dt_s) override {
    y_ = peek(u, dt_s);
    u_ = u;
    return y_;
  }
  double peek(double u, double dt_s) const override {
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
  double departing(double) const override { return y_; }
  bool rate_independent() const override { return false; }
  double slew_rate() const override { return rate_; }

 private:
  double rate_;
  double u_ = 0.0;
  double y_ = 0.0;
};

/// y follows u as fast as |y'| <= rate_per_s allows.
class SlewLimit final : public NamedBlockType {
 public:
  SlewLimit()
      : NamedBlockType("slew_limit", "limits the rate of change",
                       {above_zero("rate_per_s", "fastest change a second")}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<SlewLimiter>(block.get("rate_per_s"));
  }
};

}  // namespace

const BlockType& slew_limit_block() {
  static const SlewLimit type;
  return type;
}

}  // namespace bodesmith::chain
