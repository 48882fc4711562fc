#include <fmt/format.h>

#include "synthesis/ladders/ladder_realisation.hpp"
#include "synthesis/ladders/rc_ladder.hpp"

namespace bodesmith::synthesis {
namespace {

/// Z = R0 + sum R_k/(1 + s R_k C_k): a series chain of R||C. Values: R0, R1, C1, R2, C2, ….
class Foster1 final : public RcLadder {
 public:
  using Real = ladder_synthesis::Real;

  std::string_view name() const override { return "foster1"; }

  std::vector<LadderPart> parts(const RcImpedance& impedance) const override {
    const ladder_synthesis::Scaled z = ladder_synthesis::scaled(impedance);
    ladder_synthesis::Drawing out;
    out.resistor("a", "n1", z.high);
    const std::size_t n = z.poles.size();
    for (std::size_t k = 0; k < n; ++k) {
      Real residue = z.high;
      for (std::size_t i = 0; i < n; ++i) {
        residue *= z.zeros[i] - z.poles[k];
        if (i != k) residue /= z.poles[i] - z.poles[k];
      }
      const std::string from = fmt::format("n{}", k + 1), to = k + 1 == n ? "b" : fmt::format("n{}", k + 2);
      out.resistor(from, to, residue / z.poles[k]);
      out.capacitor(from, to, 1.0L / (residue * z.centre));
    }
    return std::move(out).parts();
  }

  std::complex<double> impedance(std::span<const double> v, std::complex<double> s) const override {
    std::complex<double> z = v[0];
    for (std::size_t i = 1; i < v.size(); i += 2) z += v[i] / (1.0 + s * v[i] * v[i + 1]);
    return z;
  }
};

}  // namespace

BODESMITH_ENTRY(RcLadder, foster1, Foster1)

const Realisation& foster1_realisation() {
  static const LadderRealisation realisation(foster1());
  return realisation;
}

}  // namespace bodesmith::synthesis
