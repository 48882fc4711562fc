#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// With w = 2 pi natural_frequency_hz, the sum of a state-variable filter's three outputs:
///   x0' = w x1,   x1' = w (u - x0 - 2 zeta x1),
///   y = lowpass_gain x0 + bandpass_gain x1 + highpass_gain (u - x0 - 2 zeta x1),
///   H(s) = (lowpass_gain + bandpass_gain s/w + highpass_gain s^2/w^2)/(1 + 2 zeta s/w + s^2/w^2):
/// any section of two poles. A notch has equal outer gains and a small middle one.
class Biquad final : public BlockType {
 public:
  Biquad()
      : BlockType("biquad", "two poles, up to two zeros anywhere: low-pass, band-pass and high-pass added",
                  {any_number("lowpass_gain", "y/u", "gain at DC").with_default(0.0),
                   any_number("bandpass_gain", "y/u", "factor of s/w").with_default(0.0),
                   any_number("highpass_gain", "y/u", "gain far above the poles").with_default(0.0),
                   above_zero("natural_frequency_hz", "Hz", "of the poles"),
                   above_zero("damping_ratio", "1", "zeta of the poles")}) {}
  Kernel kernel(const Block& block) const override {
    const double w = Hertz{block.get("natural_frequency_hz")}.rad_s().value;
    const double damping = 2.0 * block.get("damping_ratio");
    const double high = block.get("highpass_gain");
    LinearKernel k;
    k.a = {0.0, w, -w, -damping * w};
    k.b = {0.0, w};
    k.c = {block.get("lowpass_gain") - high, block.get("bandpass_gain") - damping * high};
    k.d = high;
    return k;
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    const double r = w.hz().value / block.get("natural_frequency_hz");
    return Complex(block.get("lowpass_gain") - block.get("highpass_gain") * r * r,
                   block.get("bandpass_gain") * r) /
           Complex(1.0 - r * r, 2.0 * block.get("damping_ratio") * r);
  }
  double slowest_time_constant_s(const Block& block) const override {
    return mode_time_constant_s(Hertz{block.get("natural_frequency_hz")}, block.get("damping_ratio"));
  }
  int section_order() const override { return 2; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, biquad_block, Biquad)

}  // namespace bodesmith::chain
