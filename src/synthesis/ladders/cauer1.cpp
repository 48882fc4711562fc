#include <fmt/format.h>

#include "synthesis/ladders/ladder_realisation.hpp"
#include "synthesis/ladders/rc_ladder.hpp"

namespace bodesmith::synthesis {
namespace {

/// Z = R1 + 1/(s C1 + 1/(R2 + 1/(s C2 + …))): series R, shunt C. Values: R1, C1, R2, C2, …, R(n+1).
class Cauer1 final : public RcLadder {
 public:
  using Real = ladder_synthesis::Real;

  std::string_view name() const override { return "cauer1"; }

  std::vector<LadderPart> parts(const RcImpedance& impedance) const override {
    const ladder_synthesis::Scaled z = ladder_synthesis::scaled(impedance);
    ladder_synthesis::Drawing out;
    ladder_synthesis::Polynomial p = ladder_synthesis::from_roots(z.zeros);
    for (Real& c : p) c *= z.high;
    const std::vector<Real> all =
        ladder_synthesis::continued_fraction(p, ladder_synthesis::from_roots(z.poles));
    std::string node = "a";
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i % 2 == 0) {
        const std::string next = i + 1 == all.size() ? "b" : fmt::format("n{}", i / 2 + 1);
        out.resistor(node, next, all[i]);
        node = next;
      } else {
        out.capacitor(node, "b", all[i] / z.centre);
      }
    }
    return std::move(out).parts();
  }

  std::complex<double> impedance(std::span<const double> v, std::complex<double> s) const override {
    std::complex<double> z = v.back();
    for (std::size_t i = v.size() - 1; i >= 2; i -= 2) z = v[i - 2] + 1.0 / (s * v[i - 1] + 1.0 / z);
    return z;
  }
};

}  // namespace

BODESMITH_ENTRY(RcLadder, cauer1, Cauer1)

const Realisation& cauer1_realisation() {
  static const LadderRealisation realisation(cauer1());
  return realisation;
}

}  // namespace bodesmith::synthesis
