#include <fmt/format.h>

#include "synthesis/ladders/ladder_realisation.hpp"
#include "synthesis/ladders/rc_ladder.hpp"

namespace bodesmith::synthesis {
namespace {

/// 1/Z = 1/R1 + 1/(1/(s C1) + 1/(1/R2 + …)): shunt R, series C. Values: R1, C1, R2, C2, …, R(n+1).
class Cauer2 final : public RcLadder {
 public:
  using Real = ladder_synthesis::Real;

  std::string_view name() const override { return "cauer2"; }

  std::vector<LadderPart> parts(const RcImpedance& impedance) const override {
    const ladder_synthesis::Scaled z = ladder_synthesis::scaled(impedance);
    ladder_synthesis::Drawing out;
    // In t = 1/s: Y = Q/P.
    ladder_synthesis::Polynomial p = ladder_synthesis::from_roots(z.zeros);
    const ladder_synthesis::Polynomial q = ladder_synthesis::from_roots(z.poles);
    for (Real& c : p) c *= z.high;
    const std::vector<Real> all =
        ladder_synthesis::continued_fraction({q.rbegin(), q.rend()}, {p.rbegin(), p.rend()});
    std::string node = "a";
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i % 2 == 0) {
        out.resistor(node, "b", 1.0L / all[i]);
      } else {
        const std::string next = fmt::format("n{}", i / 2 + 1);
        out.capacitor(node, next, 1.0L / (all[i] * z.centre));
        node = next;
      }
    }
    return std::move(out).parts();
  }

  std::complex<double> impedance(std::span<const double> v, std::complex<double> s) const override {
    std::complex<double> z = v.back();
    for (std::size_t i = v.size() - 1; i >= 2; i -= 2) {
      z = 1.0 / (1.0 / v[i - 2] + 1.0 / (1.0 / (s * v[i - 1]) + z));
    }
    return z;
  }
};

}  // namespace

BODESMITH_ENTRY(RcLadder, cauer2, Cauer2)

const Realisation& cauer2_realisation() {
  static const LadderRealisation realisation(cauer2());
  return realisation;
}

}  // namespace bodesmith::synthesis
