#include "chain/block.hpp"

namespace bodesmith::chain {
namespace {

class ComparatorKernel final : public MemoryKernel {
 public:
  explicit ComparatorKernel(const Block& block)
      : up_(block.get("threshold_v") + 0.5 * block.get("hysteresis_v")),
        down_(block.get("threshold_v") - 0.5 * block.get("hysteresis_v")),
        low_(block.get("low_v")),
        high_(block.get("high_v")) {}
  double reset(double u, bool) override {
    is_high_ = u > 0.5 * (up_ + down_);
    return output(is_high_);
  }
  double step(double u, double) override {
    is_high_ = next(u);
    return output(is_high_);
  }
  double peek(double u, double) const override { return output(next(u)); }
  bool rate_independent() const override { return true; }
  std::vector<double> corners() const override {
    return up_ == down_ ? std::vector<double>{up_} : std::vector<double>{down_, up_};
  }

 private:
  bool next(double u) const { return u > up_ ? true : u < down_ ? false : is_high_; }
  double output(bool high) const { return high ? high_ : low_; }
  double up_;
  double down_;
  double low_;
  double high_;
  bool is_high_ = false;
};

/// y = high_v once u has risen above threshold + hysteresis/2, low_v once it has fallen below threshold -
/// hysteresis/2. Its delay is a delay block behind it.
class Comparator final : public BlockType {
 public:
  Comparator()
      : BlockType("comparator", "two levels by a threshold with hysteresis",
                  {any_number("threshold_v", "V", "middle of the switching levels").with_default(0.0),
                   not_negative("hysteresis_v", "V", "distance of the switching levels").with_default(0.0),
                   any_number("low_v", "V", "output below").with_default(0.0),
                   any_number("high_v", "V", "output above").with_default(1.0)}) {}
  Kernel kernel(const Block& block) const override { return std::make_unique<ComparatorKernel>(block); }
};

}  // namespace

BODESMITH_ENTRY(BlockType, comparator_block, Comparator)

}  // namespace bodesmith::chain
