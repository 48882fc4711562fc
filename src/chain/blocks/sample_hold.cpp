#include <numbers>

#include "chain/block.hpp"
#include "numeric/sinc.hpp"

namespace bodesmith::chain {
namespace {

class Hold final : public SampledKernel {
 public:
  Hold(double clock_hz, bool half_cycle) : clock_hz_(clock_hz), delay_s_(half_cycle ? 0.5 / clock_hz : 0.0) {}
  double clock_hz() const override { return clock_hz_; }
  double delay_s() const override { return delay_s_; }
  double reset(double u, bool equilibrium) override { return equilibrium ? u : 0.0; }
  double update(double sample) override { return sample; }

 private:
  double clock_hz_;
  double delay_s_;
};

/// Samples at the clock's edges (the first one at the record's first sample) and holds for one cycle; with
/// half_cycle the sample appears half a cycle later, as between two phases of a switched-capacitor circuit.
/// For signals well below the clock H(jw) = sinc(f/fc) exp(-j pi f/fc), times exp(-j pi f/fc) again with
/// half_cycle.
class SampleHold final : public BlockType {
 public:
  SampleHold()
      : BlockType("sample_hold", "clocked sample and hold",
                  {above_zero("clock_hz", "Hz", "clock"),
                   flag("half_cycle", "the sample appears half a cycle later")}) {}
  /// Of the part at the input's own frequency; images about the clock's multiples come besides.
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    const double cycle = w.hz().value / block.get("clock_hz");
    const double angle = std::numbers::pi * cycle;
    return std::polar(1.0, -angle * (block.flag("half_cycle") ? 2.0 : 1.0)) * sinc(angle);
  }
  Kernel kernel(const Block& block) const override {
    return std::make_unique<Hold>(block.get("clock_hz"), block.flag("half_cycle"));
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, sample_hold_block, SampleHold)

}  // namespace bodesmith::chain
