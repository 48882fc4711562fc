#include <fmt/format.h>

#include "numeric/index.hpp"
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

  RcImpedance impedance_of(std::span<const double> v) const override {
    // (s R + E) i = 0: E v = x R v.
    const Eigen::Index n = eigen_index(v.size() / 2);
    const auto r = [&](Eigen::Index k) -> Real { return v[std_index(2 * k)]; };
    Real conductance = 0.0L;
    for (Eigen::Index k = 0; k <= n; ++k) conductance += 1.0L / r(k);
    ladder_synthesis::Matrix storing = ladder_synthesis::Matrix::Zero(n, n), loops = storing;
    for (Eigen::Index k = 0; k < n; ++k) {
      storing(k, k) = 1.0L / Real(v[std_index(2 * k + 1)]);
      loops(k, k) = r(k) + r(k + 1);
      if (k > 0) loops(k, k - 1) = loops(k - 1, k) = -r(k);
    }
    RcImpedance out;
    out.poles = ladder_synthesis::natural_frequencies(storing, loops);
    loops(0, 0) -= r(0);
    out.zeros = ladder_synthesis::natural_frequencies(storing, loops);
    out.high = static_cast<double>(1.0L / conductance);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(RcLadder, cauer2, Cauer2)

const Realisation& cauer2_realisation() {
  static const LadderRealisation realisation(cauer2());
  return realisation;
}

}  // namespace bodesmith::synthesis
