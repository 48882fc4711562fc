#include "chain/block.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

class DriftSource final : public SourceKernel {
 public:
  explicit DriftSource(double rate) : rate_(rate) {}
  double value(double t) const override { return rate_ * t; }
  double rate(double) const override { return rate_; }
  bool straight() const override { return true; }

 private:
  double rate_;
};

/// y = u + rate_per_s t, t as in the record's time_s.
class Drift final : public BlockType {
 public:
  Drift()
      : BlockType("drift", "adds a slow straight line",
                  {any_number("rate_per_s", "y/s", "units of the signal a second")}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<DriftSource>(block.get("rate_per_s"));
  }
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    return inverse_of(*std::get<std::unique_ptr<SourceKernel>>(block.kernel()), wanted);
  }
  std::optional<std::complex<double>> response(const Block&, RadPerSecond) const override { return 1.0; }
};

}  // namespace

BODESMITH_ENTRY(BlockType, drift_block, Drift)

}  // namespace bodesmith::chain
