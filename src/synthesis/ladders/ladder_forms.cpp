#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "synthesis/ladders/ladder_realisation.hpp"

namespace bodesmith::synthesis {
namespace {

using Real = long double;
using Polynomial = std::vector<Real>;  // rising powers

/// An impedance with its frequencies in units of `centre`, so that polynomials stay in range.
struct Scaled {
  std::vector<Real> poles, zeros;
  Real high = 0.0L;
  Real centre = 1.0L;
};

Scaled scaled(const RcImpedance& z) {
  Scaled out;
  out.high = z.high;
  out.centre = std::sqrt(static_cast<Real>(z.poles.front()) * z.zeros.back());
  for (const double pole : z.poles) out.poles.push_back(pole / out.centre);
  for (const double zero : z.zeros) out.zeros.push_back(zero / out.centre);
  return out;
}

Polynomial from_roots(const std::vector<Real>& roots) {
  Polynomial out = {1.0L};
  for (const Real root : roots) {
    Polynomial next(out.size() + 1, 0.0L);
    for (std::size_t i = 0; i < out.size(); ++i) {
      next[i] += root * out[i];
      next[i + 1] += out[i];
    }
    out = std::move(next);
  }
  return out;
}

/// Continued fraction of P/Q (equal degrees): constant, coefficient of s, constant, …: first the quotient of
/// the leading coefficients, then by turns.
std::vector<Real> continued_fraction(Polynomial p, Polynomial q) {
  std::vector<Real> out;
  while (!q.empty() && !p.empty()) {
    const std::size_t shift = p.size() - q.size();
    const Real quotient = p.back() / q.back();
    out.push_back(quotient);
    for (std::size_t i = 0; i < q.size(); ++i) p[i + shift] -= quotient * q[i];
    p.pop_back();
    std::swap(p, q);
  }
  return out;
}

/// Numbers the parts as they are drawn: R1, R2, …, C1, C2, ….
class Drawing {
 public:
  void resistor(const std::string& from, const std::string& to, Real value) {
    parts.push_back({true, fmt::format("R{}", ++resistors_), from, to, static_cast<double>(value)});
  }
  void capacitor(const std::string& from, const std::string& to, Real value) {
    parts.push_back({false, fmt::format("C{}", ++capacitors_), from, to, static_cast<double>(value)});
  }
  std::vector<LadderPart> parts;

 private:
  int resistors_ = 0, capacitors_ = 0;
};

class LadderForm : public RcLadder {
 public:
  std::vector<LadderPart> parts(const RcImpedance& impedance) const final {
    Drawing out;
    draw(scaled(impedance), out);
    return std::move(out.parts);
  }

 private:
  virtual void draw(Scaled z, Drawing& out) const = 0;
};

/// Z = R0 + sum R_k/(1 + s R_k C_k): a series chain of R||C. Values: R0, R1, C1, R2, C2, ….
class Foster1 final : public LadderForm {
 public:
  std::string_view name() const override { return "foster1"; }

  void draw(Scaled z, Drawing& out) const override {
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
  }

  Complex impedance(std::span<const double> v, Complex s) const override {
    Complex z = v[0];
    for (std::size_t i = 1; i < v.size(); i += 2) z += v[i] / (1.0 + s * v[i] * v[i + 1]);
    return z;
  }
};

/// Y = 1/R0 + sum s C_k/(1 + s R_k C_k): branches of R + C in parallel. Values: R0, R1, C1, R2, C2, ….
class Foster2 final : public LadderForm {
 public:
  std::string_view name() const override { return "foster2"; }

  void draw(Scaled z, Drawing& out) const override {
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
  }

  Complex impedance(std::span<const double> v, Complex s) const override {
    Complex y = 1.0 / v[0];
    for (std::size_t i = 1; i < v.size(); i += 2) y += s * v[i + 1] / (1.0 + s * v[i] * v[i + 1]);
    return 1.0 / y;
  }
};

/// Z = R1 + 1/(s C1 + 1/(R2 + 1/(s C2 + …))): series R, shunt C. Values: R1, C1, R2, C2, …, R(n+1).
class Cauer1 final : public LadderForm {
 public:
  std::string_view name() const override { return "cauer1"; }

  void draw(Scaled z, Drawing& out) const override {
    Polynomial p = from_roots(z.zeros);
    for (Real& c : p) c *= z.high;
    const std::vector<Real> all = continued_fraction(p, from_roots(z.poles));
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
  }

  Complex impedance(std::span<const double> v, Complex s) const override {
    Complex z = v.back();
    for (std::size_t i = v.size() - 1; i >= 2; i -= 2) z = v[i - 2] + 1.0 / (s * v[i - 1] + 1.0 / z);
    return z;
  }
};

/// 1/Z = 1/R1 + 1/(1/(s C1) + 1/(1/R2 + …)): shunt R, series C. Values: R1, C1, R2, C2, …, R(n+1).
class Cauer2 final : public LadderForm {
 public:
  std::string_view name() const override { return "cauer2"; }

  void draw(Scaled z, Drawing& out) const override {
    // In t = 1/s: Y = Q/P.
    Polynomial p = from_roots(z.zeros);
    const Polynomial q = from_roots(z.poles);
    for (Real& c : p) c *= z.high;
    const std::vector<Real> all = continued_fraction({q.rbegin(), q.rend()}, {p.rbegin(), p.rend()});
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
  }

  Complex impedance(std::span<const double> v, Complex s) const override {
    Complex z = v.back();
    for (std::size_t i = v.size() - 1; i >= 2; i -= 2) {
      z = 1.0 / (1.0 / v[i - 2] + 1.0 / (1.0 / (s * v[i - 1]) + z));
    }
    return z;
  }
};

}  // namespace

BODESMITH_ENTRY(RcLadder, foster1, Foster1)
BODESMITH_ENTRY(RcLadder, foster2, Foster2)
BODESMITH_ENTRY(RcLadder, cauer1, Cauer1)
BODESMITH_ENTRY(RcLadder, cauer2, Cauer2)

const Realisation& foster1_realisation() {
  static const LadderRealisation realisation(foster1());
  return realisation;
}
const Realisation& foster2_realisation() {
  static const LadderRealisation realisation(foster2());
  return realisation;
}
const Realisation& cauer1_realisation() {
  static const LadderRealisation realisation(cauer1());
  return realisation;
}
const Realisation& cauer2_realisation() {
  static const LadderRealisation realisation(cauer2());
  return realisation;
}

}  // namespace bodesmith::synthesis
