#include "chain/block.hpp"
#include "chain/inverse.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// H(s) = (1 - s/(2 pi right_zero_hz))/(1 + s/(2 pi pole_hz)): a step begins the wrong way. Equal corners: the all-pass of
/// first order.
class RightHalfPlaneZero final : public BlockType {
 public:
  RightHalfPlaneZero()
      : BlockType("right_half_plane_zero", "(1 - s/z)/(1 + s/p)",
                  {above_zero("right_zero_hz", "Hz", "corner of the zero, in the right half-plane"),
                   above_zero("pole_hz", "Hz", "corner of the pole")}) {}
  Kernel kernel(const Block& block) const override {
    return pole_zero_kernel(1.0, -Hertz{block.get("right_zero_hz")}.rad_s().value,
                            Hertz{block.get("pole_hz")}.rad_s().value);
  }
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    return inverse_of(std::get<LinearKernel>(block.kernel()), wanted);
  }
  std::optional<std::complex<double>> response(const Block& block, RadPerSecond w) const override {
    const double f = w.hz().value;
    return std::complex<double>(1.0, -f / block.get("right_zero_hz")) /
           std::complex<double>(1.0, f / block.get("pole_hz"));
  }
  double slowest_time_constant_s(const Block& block) const override {
    return 1.0 / Hertz{block.get("pole_hz")}.rad_s().value;
  }
  int section_order() const override { return 1; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, right_half_plane_zero_block, RightHalfPlaneZero)

}  // namespace bodesmith::chain
