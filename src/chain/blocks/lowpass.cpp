#include <limits>

#include "chain/block.hpp"
#include "chain/inverse.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// H(s) = 1/(1 + s/(2 pi corner_hz)): an amplifier's first-order lag.
class Lowpass final : public BlockType {
 public:
  Lowpass()
      : BlockType("lowpass", "first-order lag, 1/(1 + s/w)",
                  {above_zero("corner_hz", "Hz", "-3 dB frequency")}) {}
  Kernel kernel(const Block& block) const override {
    return pole_zero_kernel(1.0, std::numeric_limits<double>::infinity(),
                            Hertz{block.get("corner_hz")}.rad_s().value);
  }
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    return inverse_of(std::get<LinearKernel>(block.kernel()), wanted);
  }
  std::optional<std::complex<double>> response(const Block& block, RadPerSecond w) const override {
    return 1.0 / std::complex<double>(1.0, w.value / Hertz{block.get("corner_hz")}.rad_s().value);
  }
  double slowest_time_constant_s(const Block& block) const override {
    return 1.0 / Hertz{block.get("corner_hz")}.rad_s().value;
  }
  int section_order() const override { return 1; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, lowpass_block, Lowpass)

}  // namespace bodesmith::chain
