#include <algorithm>
#include <cstddef>

#include "chain/block.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// y = u + R(d/dt) sum z_i, z_i'' + 2 zeta_i w_i z_i' + w_i^2 z_i = gains[i] w_i^2 u;
/// H(s) = 1 + R(s) sum gains[i]/(1 + 2 zeta_i s/w_i + s^2/w_i^2): modes in parallel with the direct path, of either sign (modal
/// superposition: A. Preumont, Vibration Control of Active Structures, 2011, ch. 2). Neighbours of one sign have a zero
/// between them, those of opposite signs have none, or zeros in the right half-plane.
///
/// R(s) = 1; with resonator_hz above 0 it is 1 + 2 zeta_0 s/w_0 + s^2/w_0^2, and takes a resonator of these values, which
/// stands elsewhere in the chain, out of the modes' path: they then stand in parallel with that resonator, their gains are parts of
/// its gain.
class ParallelModes final : public BlockType {
 public:
  ParallelModes()
      : BlockType(
            "parallel_modes", "modes in parallel with the direct path, 1 + sum g/(1 + 2 zeta s/w + s^2/w^2)",
            {list_of(any_number("gains", "1", "share of each mode at DC, of either sign")),
             list_of(above_zero("natural_frequencies_hz", "Hz", "undamped natural frequency of each mode")),
             list_of(above_zero("damping_ratios", "1", "zeta of each mode")),
             not_negative("resonator_hz", "Hz",
                          "natural frequency of the resonator that they are in parallel with, 0: none")
                 .with_default(0.0),
             not_negative("resonator_damping_ratio", "1", "zeta of that resonator").with_default(0.0)}) {}
  std::string validate(const Block& block) const override {
    const std::size_t count = block.list("gains").size();
    return block.list("natural_frequencies_hz").size() == count &&
                   block.list("damping_ratios").size() == count
               ? ""
               : "gains, natural_frequencies_hz and damping_ratios have different lengths";
  }
  /// States of each mode as a resonator's: its deflection y, and v = y'/w. What R(s) makes of it is
  /// y + 2 zeta_0 (w/w_0) v + (w/w_0)^2 (u - y - 2 zeta v).
  Kernel kernel(const Block& block) const override {
    const auto gains = block.list("gains");
    const auto frequencies = block.list("natural_frequencies_hz");
    const auto dampings = block.list("damping_ratios");
    const std::size_t order = 2 * gains.size();
    const double resonator_hz = block.get("resonator_hz");
    const double resonator_damping = block.get("resonator_damping_ratio");
    LinearKernel k;
    k.a.assign(order * order, 0.0);
    k.b.assign(order, 0.0);
    k.c.assign(order, 0.0);
    k.d = 1.0;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      const double w = Hertz{frequencies[i]}.rad_s().value;
      const std::size_t at = 2 * i;
      k.a[at * order + at + 1] = w;
      k.a[(at + 1) * order + at] = -w;
      k.a[(at + 1) * order + at + 1] = -2.0 * dampings[i] * w;
      k.b[at + 1] = w;
      const double ratio = resonator_hz > 0.0 ? frequencies[i] / resonator_hz : 0.0;
      k.c[at] = gains[i] * (1.0 - ratio * ratio);
      k.c[at + 1] = gains[i] * 2.0 * ratio * (resonator_damping - ratio * dampings[i]);
      k.d += gains[i] * ratio * ratio;
    }
    return k;
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    // Asked for each point of each run: in the order of the specs, without copies.
    const auto& values = block.parameters();
    const std::size_t count = (values.size() - kResonatorValues) / kLists;
    const double hz = w.hz().value;
    Complex sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double r = hz / values[count + i].value;
      sum += values[i].value * inverse_of_mode(r, values[2 * count + i].value);
    }
    const double resonator_hz = values[kLists * count].value;
    if (!(resonator_hz > 0.0)) return 1.0 + sum;
    const double r = hz / resonator_hz;
    return 1.0 + Complex(1.0 - r * r, 2.0 * values[kLists * count + 1].value * r) * sum;
  }
  double slowest_time_constant_s(const Block& block) const override {
    const auto frequencies = block.list("natural_frequencies_hz");
    const auto dampings = block.list("damping_ratios");
    double slowest = 0.0;
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      slowest = std::max(slowest, mode_time_constant_s(Hertz{frequencies[i]}, dampings[i]));
    return slowest;
  }
  int section_order() const override { return 2; }

 private:
  /// Lists of a number each mode, and the numbers behind them.
  static constexpr std::size_t kLists = 3;
  static constexpr std::size_t kResonatorValues = 2;

  /// 1/(1 - r^2 + 2 zeta r j)
  static Complex inverse_of_mode(double r, double damping) {
    const double real = 1.0 - r * r;
    const double imaginary = 2.0 * damping * r;
    const double size = real * real + imaginary * imaginary;
    return {real / size, -imaginary / size};
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, parallel_modes_block, ParallelModes)

}  // namespace bodesmith::chain
