#include <algorithm>

#include "chain/block.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

class DeadZoneCurve final : public CurveKernel {
 public:
  explicit DeadZoneCurve(double width) : half_(0.5 * width) {}
  double value(double u) const override { return u - std::clamp(u, -half_, half_); }
  double slope(double u) const override { return u > half_ || u < -half_ ? 1.0 : 0.0; }
  std::vector<double> corners() const override { return {-half_, half_}; }
  void values(const double* u, double* y, std::size_t count) const override {
    for (std::size_t i = 0; i < count; ++i) y[i] = u[i] - std::clamp(u[i], -half_, half_);
  }

 private:
  double half_;
};

/// y = 0 for |u| <= width/2, otherwise u moved by width/2 towards 0.
class DeadZone final : public BlockType {
 public:
  DeadZone()
      : BlockType("dead_zone", "no response near zero",
                  {not_negative("width", "u", "full width, units of the input")}) {}
  Kernel kernel(const Block& block) const override {
    return std::make_unique<DeadZoneCurve>(block.get("width"));
  }
  /// Over the dead zone by a jump; 0 where nothing is wanted.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    const double half = 0.5 * block.get("width");
    FoundInput out;
    for (const double y : wanted.values) out.values.push_back(y > 0.0 ? y + half : y < 0.0 ? y - half : 0.0);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, dead_zone_block, DeadZone)

}  // namespace bodesmith::chain
