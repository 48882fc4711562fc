#include <algorithm>

#include "chain/block.hpp"
#include "chain/inverse.hpp"

namespace bodesmith::chain {
namespace {

class SaturationCurve final : public CurveKernel {
 public:
  SaturationCurve(double lower, double upper) : lower_(lower), upper_(upper) {}
  double value(double u) const override { return std::clamp(u, lower_, upper_); }
  double slope(double u) const override { return u > lower_ && u < upper_ ? 1.0 : 0.0; }
  std::vector<double> corners() const override { return {lower_, upper_}; }
  void values(const double* u, double* y, std::size_t count) const override {
    for (std::size_t i = 0; i < count; ++i) y[i] = std::clamp(u[i], lower_, upper_);
  }

 private:
  double lower_;
  double upper_;
};

/// y = u held between lower and upper.
class Saturation final : public BlockType {
 public:
  Saturation()
      : BlockType("saturation", "limits the amplitude",
                  {any_number("lower", "y", "lowest output"), any_number("upper", "y", "highest output")}) {}
  std::string validate(const Block& block) const override {
    return block.get("lower") < block.get("upper") ? "" : "lower is not below upper";
  }
  Kernel kernel(const Block& block) const override {
    // A fit may try limits the wrong way round on its way; the order is then taken as meant.
    const auto [low, high] = std::minmax({block.get("lower"), block.get("upper")});
    return std::make_unique<SaturationCurve>(low, high);
  }
  /// Itself: what is beyond the limits no input gives.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    FoundInput out;
    for (std::size_t i = 0; i < wanted.values.size(); ++i) {
      out.values.push_back(std::clamp(wanted.values[i], block.get("lower"), block.get("upper")));
      if (out.values[i] != wanted.values[i]) out.out_of_reach.push_back(i);
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, saturation_block, Saturation)

}  // namespace bodesmith::chain
