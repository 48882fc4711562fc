#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// y = gain u + offset.
class Gain final : public BlockType {
 public:
  Gain()
      : BlockType("gain", "y = gain u + offset",
                  {any_number("gain", "y/u", "factor").with_default(1.0),
                   any_number("offset", "y", "constant added to the output").with_default(0.0)}) {}
  Kernel kernel(const Block& block) const override {
    return gain_kernel(block.get("gain"), block.get("offset"));
  }
  std::optional<Complex> response(const Block& block, RadPerSecond) const override {
    return block.get("gain");
  }
  std::optional<Affine> affine(const Block& block) const override {
    return Affine{block.get("gain"), block.get("offset")};
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, gain_block, Gain)

}  // namespace bodesmith::chain
