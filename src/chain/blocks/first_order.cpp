#include <limits>

#include "chain/block.hpp"

namespace bodesmith::chain {
namespace {

/// With p = 2 pi pole_hz and r = pole_hz/zero_hz, z' = -p (z - u), y = gain (z + r (u - z)):
/// H(s) = gain (1 + s/(2 pi zero_hz))/(1 + s/p).
class FirstOrder : public BlockType {
 public:
  using BlockType::BlockType;
  Kernel kernel(const Block& block) const final {
    const Corners at = corners(block);
    return pole_zero_kernel(at.gain, at.zero.rad_s().value, at.pole.rad_s().value);
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const final {
    const double f = w.hz().value;
    const Corners at = corners(block);
    return at.gain * Complex(1.0, f / at.zero.value) / Complex(1.0, f / at.pole.value);
  }
  double slowest_time_constant_s(const Block& block) const final {
    return 1.0 / corners(block).pole.rad_s().value;
  }
  int section_order() const final { return 1; }

 protected:
  struct Corners {
    double gain = 1.0;
    Hertz pole;
    Hertz zero{std::numeric_limits<double>::infinity()};  ///< below 0: in the right half-plane
  };
  virtual Corners corners(const Block& block) const = 0;
};

/// y' = -w (y - u), w = 2 pi corner_hz; H(s) = 1/(1 + s/w): an amplifier's first-order lag.
class Lowpass final : public FirstOrder {
 public:
  Lowpass()
      : FirstOrder("lowpass", "first-order lag, 1/(1 + s/w)",
                   {above_zero("corner_hz", "Hz", "-3 dB frequency")}) {}

 private:
  Corners corners(const Block& block) const override { return {1.0, {block.get("corner_hz")}}; }
};

/// One integer section of a compensator.
class PoleZero final : public FirstOrder {
 public:
  PoleZero()
      : FirstOrder("pole_zero", "gain (1 + s/z)/(1 + s/p)",
                   {any_number("gain", "y/u", "gain at DC").with_default(1.0),
                    above_zero("zero_hz", "Hz", "corner of the zero"),
                    above_zero("pole_hz", "Hz", "corner of the pole")}) {}

 private:
  Corners corners(const Block& block) const override {
    return {block.get("gain"), {block.get("pole_hz")}, {block.get("zero_hz")}};
  }
};

/// H(s) = (1 - s/(2 pi right_zero_hz))/(1 + s/(2 pi pole_hz)): a step begins the wrong way (pole_zero with zero_hz =
/// -right_zero_hz). Equal corners: the all-pass of first order.
class RightHalfPlaneZero final : public FirstOrder {
 public:
  RightHalfPlaneZero()
      : FirstOrder("right_half_plane_zero", "(1 - s/z)/(1 + s/p)",
                   {above_zero("right_zero_hz", "Hz", "corner of the zero, in the right half-plane"),
                    above_zero("pole_hz", "Hz", "corner of the pole")}) {}

 private:
  Corners corners(const Block& block) const override {
    return {1.0, {block.get("pole_hz")}, {-block.get("right_zero_hz")}};
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, lowpass_block, Lowpass)
BODESMITH_ENTRY(BlockType, pole_zero_block, PoleZero)
BODESMITH_ENTRY(BlockType, right_half_plane_zero_block, RightHalfPlaneZero)

}  // namespace bodesmith::chain
