#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// y(t) = u(t - delay_s); H(s) = exp(-s delay_s).
class Delay final : public BlockType {
 public:
  Delay() : BlockType("delay", "pure delay", {not_negative("delay_s", "s", "delay")}) {}
  Kernel kernel(const Block& block) const override {
    LinearKernel k = gain_kernel(1.0);
    k.delay_s = block.get("delay_s");
    return k;
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    return std::polar(1.0, -w.value * block.get("delay_s"));
  }
  double slowest_time_constant_s(const Block& block) const override { return block.get("delay_s") / 7.0; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, delay_block, Delay)

}  // namespace bodesmith::chain
