
#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// y = gain 10^(db_per_v control_v/20) u + control_feedthrough control_v: a gain set by a constant voltage,
/// exponential ("linear in dB") for db_per_v other than 0.
class VoltageControlledGain final : public BlockType {
 public:
  VoltageControlledGain()
      : BlockType(
            "voltage_controlled_gain", "gain set by a control voltage",
            {any_number("gain", "y/u", "gain at a control voltage of 0").with_default(1.0),
             any_number("control_v", "V", "control voltage").with_default(0.0),
             any_number("slope_db_per_v", "dB/V", "change of the gain").with_default(0.0),
             any_number("control_feedthrough", "1", "part of the control voltage that reaches the output")
                 .with_default(0.0)}) {}
  Kernel kernel(const Block& block) const override {
    return gain_kernel(gain_of(block), block.get("control_feedthrough") * block.get("control_v"));
  }
  std::optional<Complex> response(const Block& block, RadPerSecond) const override { return gain_of(block); }

 private:
  static double gain_of(const Block& block) {
    return block.get("gain") * from_decibel(block.get("slope_db_per_v") * block.get("control_v"));
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, voltage_controlled_gain_block, VoltageControlledGain)

}  // namespace bodesmith::chain
