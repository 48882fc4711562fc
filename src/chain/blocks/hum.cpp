#include <cmath>

#include "chain/block.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

class HumSource final : public SourceKernel {
 public:
  HumSource(double amplitude, double w, double phase) : amplitude_(amplitude), w_(w), phase_(phase) {}
  double value(double t) const override { return amplitude_ * std::sin(w_ * t + phase_); }
  double rate(double t) const override { return amplitude_ * w_ * std::cos(w_ * t + phase_); }

 private:
  double amplitude_;
  double w_;
  double phase_;
};

/// y = u + amplitude sin(2 pi frequency_hz t + phase_deg), t as in the record's time_s.
class Hum final : public BlockType {
 public:
  Hum()
      : BlockType("hum", "adds a sinusoid of the mains",
                  {any_number("amplitude", "y", "peak, units of the signal"),
                   above_zero("frequency_hz", "Hz", "frequency"),
                   any_number("phase_deg", "deg", "phase at t = 0").with_default(0.0)}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<HumSource>(block.get("amplitude"), Hertz{block.get("frequency_hz")}.rad_s().value,
                                       to_radians(block.get("phase_deg")));
  }
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    return inverse_of(*std::get<std::unique_ptr<SourceKernel>>(block.kernel()), wanted);
  }
  std::optional<std::complex<double>> response(const Block&, RadPerSecond) const override { return 1.0; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, hum_block, Hum)

}  // namespace bodesmith::chain
