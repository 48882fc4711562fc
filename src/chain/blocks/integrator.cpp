#include "chain/block.hpp"

namespace bodesmith::chain {
namespace {

/// Where the integrator of the engines ends, rad/s: their state spaces have no pole on the axis. A day's record is off by
/// 1e-7 of itself.
constexpr double kLeakRadS = 1e-12;

/// z' = gain_per_s u, z = 0 at the start, y = z + proportional u: H(s) = gain_per_s/s + proportional.
class Integrator final : public BlockType {
 public:
  Integrator()
      : BlockType(
            "integrator", "gain/s, from 0; with `proportional` a PI",
            {any_number("gain_per_s", "y/(u s)", "slope of y for an input of 1"),
             any_number("proportional", "y/u", "gain of a path in parallel with it").with_default(0.0)}) {}
  Kernel kernel(const Block& block) const override {
    // The state is the integral itself, so that tolerances mean what they say.
    LinearKernel k;
    k.a = {-kLeakRadS};
    k.b = {block.get("gain_per_s")};
    k.c = {1.0};
    k.d = block.get("proportional");
    return k;
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    return block.get("gain_per_s") / Complex(0.0, w.value) + block.get("proportional");
  }
  int section_order() const override { return 1; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, integrator_block, Integrator)

}  // namespace bodesmith::chain
