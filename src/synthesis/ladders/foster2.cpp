#include <fmt/format.h>

#include "synthesis/ladders/ladder_realisation.hpp"
#include "synthesis/ladders/rc_ladder.hpp"

namespace bodesmith::synthesis {
namespace {

/// Y = 1/R0 + sum s C_k/(1 + s R_k C_k): branches of R + C in parallel. Values: R0, R1, C1, R2, C2, ….
class Foster2 final : public RcLadder {
 public:
  using Real = ladder_synthesis::Real;

  std::string_view name() const override { return "foster2"; }

  std::vector<LadderPart> parts(const RcImpedance& impedance) const override {
    const ladder_synthesis::Scaled z = ladder_synthesis::scaled(impedance);
    ladder_synthesis::Drawing out;
    // Y/s = Y(0)/s + sum y_k/(s + q_k).
    const std::size_t n = z.zeros.size();
    Real rest = 1.0L / z.high;
    for (std::size_t i = 0; i < n; ++i) rest *= z.poles[i] / z.zeros[i];
    out.resistor("a", "b", 1.0L / rest);
    for (std::size_t k = 0; k < n; ++k) {
      Real y = 1.0L / z.high / -z.zeros[k];
      for (std::size_t i = 0; i < n; ++i) {
        y *= z.poles[i] - z.zeros[k];
        if (i != k) y /= z.zeros[i] - z.zeros[k];
      }
      const std::string middle = fmt::format("n{}", k + 1);
      out.resistor("a", middle, 1.0L / y);
      out.capacitor(middle, "b", y / (z.zeros[k] * z.centre));
    }
    return std::move(out).parts();
  }

  std::complex<double> impedance(std::span<const double> v, std::complex<double> s) const override {
    std::complex<double> y = 1.0 / v[0];
    for (std::size_t i = 1; i < v.size(); i += 2) y += s * v[i + 1] / (1.0 + s * v[i] * v[i + 1]);
    return 1.0 / y;
  }
};

}  // namespace

BODESMITH_ENTRY(RcLadder, foster2, Foster2)

const Realisation& foster2_realisation() {
  static const LadderRealisation realisation(foster2());
  return realisation;
}

}  // namespace bodesmith::synthesis
