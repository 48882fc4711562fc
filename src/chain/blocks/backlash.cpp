#include <algorithm>

#include "chain/block.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

class Play final : public MemoryKernel {
 public:
  explicit Play(double width) : half_(0.5 * width) {}
  double reset(double u, bool equilibrium) override {
    return y_ = equilibrium ? u : std::clamp(0.0, u - half_, u + half_);
  }
  double step(double u, double) override { return y_ = peek(u, 0.0); }
  double peek(double u, double) const override { return std::clamp(y_, u - half_, u + half_); }
  bool rate_independent() const override { return true; }

 private:
  double half_;
  double y_ = 0.0;
};

/// Play: y stays until the input pushes it, max(u - width/2, min(u + width/2, y)). At rest the output stands
/// in the middle, y = u.
class Backlash final : public BlockType {
 public:
  Backlash()
      : BlockType("backlash", "play of constant width",
                  {not_negative("width", "u", "full width, units of the input")}) {}
  Kernel kernel(const Block& block) const override { return std::make_unique<Play>(block.get("width")); }
  /// Half the width ahead of what is wanted, on the side to which that moves: a jump where it turns.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    const double half = 0.5 * block.get("width");
    FoundInput out;
    double side = 0.0;
    for (std::size_t i = 0; i < wanted.values.size(); ++i) {
      const double move = i == 0 ? 0.0 : wanted.values[i] - wanted.values[i - 1];
      if (move != 0.0) side = move > 0.0 ? half : -half;
      out.values.push_back(wanted.values[i] + side);
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, backlash_block, Backlash)

}  // namespace bodesmith::chain
