#include "chain/block.hpp"
#include "chain/inverse.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// H(s) = gain (1 + s/(2 pi zero_hz))/(1 + s/(2 pi pole_hz)): one integer section of a compensator.
class PoleZero final : public BlockType {
 public:
  PoleZero()
      : BlockType("pole_zero", "gain (1 + s/z)/(1 + s/p)",
                  {any_number("gain", "y/u", "gain at DC").with_default(1.0),
                   above_zero("zero_hz", "Hz", "corner of the zero"),
                   above_zero("pole_hz", "Hz", "corner of the pole")}) {}
  Kernel kernel(const Block& block) const override {
    return pole_zero_kernel(block.get("gain"), Hertz{block.get("zero_hz")}.rad_s().value,
                            Hertz{block.get("pole_hz")}.rad_s().value);
  }
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    return inverse_of(std::get<LinearKernel>(block.kernel()), wanted);
  }
  std::optional<std::complex<double>> response(const Block& block, RadPerSecond w) const override {
    const double f = w.hz().value;
    return block.get("gain") * std::complex<double>(1.0, f / block.get("zero_hz")) /
           std::complex<double>(1.0, f / block.get("pole_hz"));
  }
  double slowest_time_constant_s(const Block& block) const override {
    return 1.0 / Hertz{block.get("pole_hz")}.rad_s().value;
  }
  int section_order() const override { return 1; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, pole_zero_block, PoleZero)

}  // namespace bodesmith::chain
