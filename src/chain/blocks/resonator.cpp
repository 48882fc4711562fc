#include <cmath>

#include "chain/block.hpp"
#include "chain/inverse.hpp"
#include "chain/kernel.hpp"

namespace bodesmith::chain {
namespace {

/// With w = 2 pi natural_frequency_hz, states x0 = y and x1 = y'/w:
///   x0' = w x1
///   x1' = w (gain u - x0 - 2 zeta x1) + w n,   n = -(quadratic y^2 + cubic y^3) - drag |y'| y' / w
StateSpace linear_part(const Block& block) {
  const double w = Hertz{block.get("natural_frequency_hz")}.rad_s().value;
  StateSpace k;
  k.a = {0.0, w, -w, -2.0 * block.get("damping_ratio") * w};
  k.b = {0.0, w * block.get("gain")};
  k.c = {1.0, 0.0};
  return k;
}

class NonlinearResonator final : public OdeKernel {
 public:
  explicit NonlinearResonator(const Block& block)
      : linear_(linear_part(block)),
        entry_{0.0, linear_.a[1]},
        gain_(block.get("gain")),
        quadratic_(block.get("quadratic")),
        cubic_(block.get("cubic")),
        drag_(block.get("drag") * linear_.a[1]) {}  // |y'| y' / w = w |x1| x1

  const StateSpace& linear() const override { return linear_; }
  const std::vector<double>& entry() const override { return entry_; }
  double nonlinear(const double* x, double) const override {
    return -(quadratic_ + cubic_ * x[0]) * x[0] * x[0] - drag_ * std::abs(x[1]) * x[1];
  }
  double nonlinear_gradient(const double* x, double, double* by_x) const override {
    by_x[0] = -(2.0 * quadratic_ + 3.0 * cubic_ * x[0]) * x[0];
    by_x[1] = -2.0 * drag_ * std::abs(x[1]);
    return 0.0;
  }
  void equilibrium(double u, double* x) const override {
    // y + q y^2 + c y^3 = gain u: the branch that starts at y = 0, followed from there in steps.
    double y = 0.0;
    for (int part = 1; part <= 64; ++part) {
      const double load = gain_ * u * part / 64.0;
      for (int i = 0; i < 50; ++i) {
        const double change = (load - y - (quadratic_ + cubic_ * y) * y * y) /
                              (1.0 + (2.0 * quadratic_ + 3.0 * cubic_ * y) * y);
        if (!std::isfinite(change)) break;
        y += change;
        if (std::abs(change) <= 1e-15 * std::abs(y)) break;
      }
    }
    x[0] = y;
    x[1] = 0.0;
  }

 private:
  StateSpace linear_;
  std::vector<double> entry_;
  double gain_;
  double quadratic_;
  double cubic_;
  double drag_;
};

/// y'' + 2 zeta w y' + w^2 (y + quadratic y^2 + cubic y^3) + drag w |y'| y' = gain w^2 u;
/// without quadratic, cubic and drag H(s) = gain/(1 + 2 zeta s/w + s^2/w^2).
class Resonator final : public BlockType {
 public:
  Resonator()
      : BlockType("resonator", "second-order mode; nonlinear spring and drag if given",
                  {any_number("gain", "y/u", "gain at DC").with_default(1.0),
                   above_zero("natural_frequency_hz", "Hz", "undamped natural frequency"),
                   above_zero("damping_ratio", "1", "zeta"),
                   any_number("quadratic", "1/y", "spring, per unit of y").with_default(0.0),
                   any_number("cubic", "1/y²", "spring, per unit of y squared").with_default(0.0),
                   any_number("drag", "s/y", "factor of w |y'| y', s per unit of y").with_default(0.0)}) {}

  Kernel kernel(const Block& block) const override {
    if (is_linear(block)) return LinearKernel{linear_part(block)};
    return std::make_unique<NonlinearResonator>(block);
  }
  /// Of the linear part, to whose input the forces of spring and drag are added at the wanted output.
  std::optional<FoundInput> inverse(const Block& block, const WantedOutput& wanted) const override {
    const double gain = block.get("gain");
    if (gain == 0.0) return std::nullopt;
    FoundInput out = inverse_of(LinearKernel{linear_part(block)}, wanted);
    if (is_linear(block)) return out;
    const NonlinearResonator kernel(block);
    const double w = Hertz{block.get("natural_frequency_hz")}.rad_s().value;
    const std::vector<double>& y = wanted.values;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const std::size_t before = i == 0 ? 0 : i - 1;
      const std::size_t next = std::min(i + 1, y.size() - 1);
      const double span = wanted.step_s * static_cast<double>(next - before);
      const double x[2] = {y[i], span > 0.0 ? (y[next] - y[before]) / (span * w) : 0.0};
      out.values[i] -= kernel.nonlinear(x, 0.0) / gain;
    }
    return out;
  }
  std::optional<Complex> response(const Block& block, RadPerSecond w) const override {
    if (!is_linear(block)) return std::nullopt;
    const double r = w.hz().value / block.get("natural_frequency_hz");
    return block.get("gain") / Complex(1.0 - r * r, 2.0 * block.get("damping_ratio") * r);
  }

  double slowest_time_constant_s(const Block& block) const override {
    return mode_time_constant_s(Hertz{block.get("natural_frequency_hz")}, block.get("damping_ratio"));
  }
  int section_order() const override { return 2; }

 private:
  static bool is_linear(const Block& block) {
    return block.get("quadratic") == 0.0 && block.get("cubic") == 0.0 && block.get("drag") == 0.0;
  }
};

}  // namespace

BODESMITH_ENTRY(BlockType, resonator_block, Resonator)

}  // namespace bodesmith::chain
