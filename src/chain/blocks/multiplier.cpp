#include "chain/block.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

/// y = (u + x_offset)(u + y_offset)/scale + x_feedthrough u + z_offset.
class SquarerCurve final : public CurveKernel {
 public:
  explicit SquarerCurve(const Block& block) {
    const double scale = block.get("scale_v");
    const double a = block.get("x_offset_v");
    const double b = block.get("y_offset_v");
    c_ = {a * b / scale + block.get("z_offset_v"), (a + b) / scale + block.get("feedthrough"), 1.0 / scale};
  }
  double value(double u) const override { return c_[0] + u * (c_[1] + u * c_[2]); }
  double slope(double u) const override { return c_[1] + 2.0 * u * c_[2]; }
  const std::vector<double>* polynomial() const override { return &c_; }

 private:
  std::vector<double> c_;
};

/// An analog multiplier (AD835: W = X Y/U + Z) with the signal on both inputs, as it makes the square of the
/// disturbance generator:
///   y = (u + x_offset)(u + y_offset)/scale + feedthrough u + z_offset.
/// Its bandwidth is a lowpass block behind it.
class Multiplier final : public BlockType {
 public:
  Multiplier()
      : BlockType(
            "multiplier", "squarer with scale, offsets and feedthrough",
            {above_zero("scale_v", "V", "U: volts in for which volts out are the same").with_default(1.0),
             any_number("x_offset_v", "V", "offset of the X input").with_default(0.0),
             any_number("y_offset_v", "V", "offset of the Y input").with_default(0.0),
             any_number("z_offset_v", "V", "offset of the output").with_default(0.0),
             any_number("feedthrough", "1", "part of the input that reaches the output directly")
                 .with_default(0.0)}) {}
  Kernel kernel(const Block& block) const override { return std::make_unique<SquarerCurve>(block); }
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    return inverse_of_polynomial(*SquarerCurve(block).polynomial(), wanted);
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, multiplier_block, Multiplier)

}  // namespace bodesmith::chain
