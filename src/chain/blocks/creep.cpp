#include <algorithm>

#include "chain/block.hpp"

namespace bodesmith::chain {
namespace {

/// y = u + sum z_i, z_i' = (gains[i] u - z_i)/time_constants_s[i];
/// H(s) = 1 + sum gains[i]/(1 + s time_constants_s[i]): slow relaxation in parallel with the direct path.
class Creep final : public BlockType {
 public:
  Creep()
      : BlockType("creep", "slow relaxation, 1 + sum g/(1 + s tau)",
                  {list_of(any_number("gains", "1", "share of each relaxation")),
                   list_of(above_zero("time_constants_s", "s", "time constant of each relaxation"))}) {}
  std::string validate(const Block& block) const override {
    return block.list("gains").size() == block.list("time_constants_s").size()
               ? ""
               : "gains and time_constants_s have different lengths";
  }
  Kernel kernel(const Block& block) const override {
    const auto gains = block.list("gains");
    const auto times = block.list("time_constants_s");
    LinearKernel k;
    const std::size_t n = gains.size();
    k.a.assign(n * n, 0.0);
    k.b.resize(n);
    k.c = gains;
    k.d = 1.0;
    for (std::size_t i = 0; i < n; ++i) {
      k.a[i * n + i] = -1.0 / times[i];
      k.b[i] = 1.0 / times[i];
    }
    return k;
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    const auto gains = block.list("gains");
    const auto times = block.list("time_constants_s");
    Complex h = 1.0;
    for (std::size_t i = 0; i < gains.size(); ++i) h += gains[i] / Complex(1.0, w.value * times[i]);
    return h;
  }
  double slowest_time_constant_s(const Block& block) const override {
    double slowest = 0.0;
    for (const double time : block.list("time_constants_s")) slowest = std::max(slowest, time);
    return slowest;
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, creep_block, Creep)

}  // namespace bodesmith::chain
