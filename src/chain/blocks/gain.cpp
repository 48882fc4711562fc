#include "chain/blocks/block_list.hpp"
#include "chain/linear_kernel.hpp"

namespace bodesmith::chain {
namespace {

/// y = gain u + offset.
class Gain final : public NamedBlockType {
 public:
  Gain()
      : NamedBlockType(
            "gain", "y = gain u + offset",
            {any_number("gain", "factor", 1.0), any_number("offset", "constant added to the output", 0.0)}) {}
  Kernel kernel(const Block& block) const override {
    return gain_kernel(block.get("gain"), block.get("offset"));
  }
  std::optional<std::complex<double>> response(const Block& block, RadPerSecond) const override {
    return block.get("gain");
  }
  std::optional<Affine> affine(const Block& block) const override {
    return Affine{block.get("gain"), block.get("offset")};
  }
};

}  // namespace

const BlockType& gain_block() {
  static const Gain type;
  return type;
}

}  // namespace bodesmith::chain
