#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// With w = 2 pi corner_hz, y = gain (u - z) and z' = w (u - z): H(s) = gain (s/w)/(1 + s/w), 0 at rest.
class Highpass final : public BlockType {
 public:
  Highpass()
      : BlockType("highpass", "first-order lead without a gain at rest, gain (s/w)/(1 + s/w)",
                  {any_number("gain", "y/u", "far above the corner").with_default(1.0),
                   above_zero("corner_hz", "Hz", "-3 dB frequency")}) {}
  Kernel kernel(const Block& block) const override {
    const double w = Hertz{block.get("corner_hz")}.rad_s().value;
    LinearKernel k;
    k.a = {-w};
    k.b = {w};
    k.c = {-block.get("gain")};
    k.d = block.get("gain");
    return k;
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    const double ratio = w.hz().value / block.get("corner_hz");
    return block.get("gain") * Complex(0.0, ratio) / Complex(1.0, ratio);
  }
  double slowest_time_constant_s(const Block& block) const override {
    return 1.0 / Hertz{block.get("corner_hz")}.rad_s().value;
  }
  int section_order() const override { return 1; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, highpass_block, Highpass)

}  // namespace bodesmith::chain
