#include "circuit/fractional_element.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "circuit/network_of_two_terminals.hpp"

namespace bodesmith {
namespace {

using Real = long double;
using Polynomial = std::vector<Real>;  // rising powers

/// Poles and zeros of Z in units of `centre`, and Z(infinity).
struct Rational {
  std::vector<Real> poles, zeros;
  Real high = 0.0L;
  Real centre = 1.0L;
};

Rational oustaloup(double alpha, double q, Band band, int order) {
  const Real low = static_cast<Real>(band.from.rad_s().value) / 10.0L;
  const Real high = static_cast<Real>(band.to.rad_s().value) * 10.0L;
  Rational out;
  out.centre = std::sqrt(low * high);
  for (int k = 1; k <= order; ++k) {
    const auto at = [&](Real shift) {
      return low * std::pow(high / low, (k - 0.5L + shift) / order) / out.centre;
    };
    out.poles.push_back(at(-0.5L * alpha));
    out.zeros.push_back(at(0.5L * alpha));
  }
  out.high = std::pow(high, -static_cast<Real>(alpha)) / q;
  return out;
}

Polynomial from_roots(const std::vector<Real>& roots) {
  Polynomial out = {1.0L};
  for (const Real root : roots) {
    Polynomial next(out.size() + 1, 0.0L);
    for (size_t i = 0; i < out.size(); ++i) {
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
    const size_t shift = p.size() - q.size();
    const Real quotient = p.back() / q.back();
    out.push_back(quotient);
    for (size_t i = 0; i < q.size(); ++i) p[i + shift] -= quotient * q[i];
    p.pop_back();
    std::swap(p, q);
  }
  return out;
}

class Builder {
 public:
  Builder(const Rational& z, LadderForm form) : z_(z) {
    switch (form) {
      case LadderForm::foster1:
        foster1();
        break;
      case LadderForm::foster2:
        foster2();
        break;
      case LadderForm::cauer1:
        cauer1();
        break;
      case LadderForm::cauer2:
        cauer2();
        break;
    }
  }
  std::vector<FractionalElement::Part> parts() && { return std::move(parts_); }

 private:
  void add(bool resistor, const std::string& from, const std::string& to, Real value) {
    int& count = resistor ? resistors_ : capacitors_;
    ++count;
    parts_.push_back({resistor, fmt::format("{}{}", resistor ? "R" : "C", count), from, to,
                      static_cast<double>(value), static_cast<double>(value)});
  }

  void foster1() {
    add(true, "a", "n1", z_.high);
    const size_t n = z_.poles.size();
    for (size_t k = 0; k < n; ++k) {
      Real residue = z_.high;
      for (size_t i = 0; i < n; ++i) {
        residue *= z_.zeros[i] - z_.poles[k];
        if (i != k) residue /= z_.poles[i] - z_.poles[k];
      }
      const std::string from = fmt::format("n{}", k + 1), to = k + 1 == n ? "b" : fmt::format("n{}", k + 2);
      add(true, from, to, residue / z_.poles[k]);
      add(false, from, to, 1.0L / (residue * z_.centre));
    }
  }

  /// Y/s = Y(0)/s + sum y_k/(s + q_k).
  void foster2() {
    const size_t n = z_.zeros.size();
    Real rest = 1.0L / z_.high;
    for (size_t i = 0; i < n; ++i) rest *= z_.poles[i] / z_.zeros[i];
    add(true, "a", "b", 1.0L / rest);
    for (size_t k = 0; k < n; ++k) {
      Real y = 1.0L / z_.high / -z_.zeros[k];
      for (size_t i = 0; i < n; ++i) {
        y *= z_.poles[i] - z_.zeros[k];
        if (i != k) y /= z_.zeros[i] - z_.zeros[k];
      }
      const std::string middle = fmt::format("n{}", k + 1);
      add(true, "a", middle, 1.0L / y);
      add(false, middle, "b", y / (z_.zeros[k] * z_.centre));
    }
  }

  void cauer1() {
    Polynomial p = from_roots(z_.zeros);
    for (Real& c : p) c *= z_.high;
    const std::vector<Real> all = continued_fraction(p, from_roots(z_.poles));
    std::string node = "a";
    for (size_t i = 0; i < all.size(); ++i) {
      if (i % 2 == 0) {
        const std::string next = i + 1 == all.size() ? "b" : fmt::format("n{}", i / 2 + 1);
        add(true, node, next, all[i]);
        node = next;
      } else {
        add(false, node, "b", all[i] / z_.centre);
      }
    }
  }

  /// In t = 1/s: Y = Q/P.
  void cauer2() {
    Polynomial p = from_roots(z_.zeros), q = from_roots(z_.poles);
    for (Real& c : p) c *= z_.high;
    const Polynomial p_t(p.rbegin(), p.rend()), q_t(q.rbegin(), q.rend());
    const std::vector<Real> all = continued_fraction(q_t, p_t);
    std::string node = "a";
    for (size_t i = 0; i < all.size(); ++i) {
      if (i % 2 == 0) {
        add(true, node, "b", 1.0L / all[i]);
      } else {
        const std::string next = fmt::format("n{}", i / 2 + 1);
        add(false, node, next, 1.0L / (all[i] * z_.centre));
        node = next;
      }
    }
  }

  const Rational& z_;
  std::vector<FractionalElement::Part> parts_;
  int resistors_ = 0, capacitors_ = 0;
};

}  // namespace

std::complex<double> FractionalElement::ideal(RadPerSecond w) const {
  return 1.0 / (q * std::pow(std::complex<double>(0.0, w.value), alpha));
}

std::complex<double> FractionalElement::impedance(RadPerSecond w) const {
  std::vector<TwoTerminalPart> network;
  for (const Part& part : parts) network.push_back({part.resistor, part.from, part.to, part.realised});
  return impedance_between(network, "a", "b", w);
}

std::string FractionalElement::subcircuit(const std::string& name) const {
  std::string out = fmt::format("* 1/(Q s^alpha), alpha = {}, Q = {:.6g}\n.subckt {} a b\n", alpha, q, name);
  for (const Part& part : parts)
    out += fmt::format("{} {} {} {:.12g}\n", part.name, part.from, part.to, part.realised);
  return out + ".ends " + name + "\n";
}

FractionalElement make_fractional_element(double alpha, double q, Band band, int order, LadderForm form,
                                          const Series& resistors, const Series& capacitors) {
  if (!(alpha > 0.0) || !(alpha < 1.0))
    throw DesignError(fmt::format("alpha is {}, expected 0 to 1, both left out", alpha));
  if (!(q > 0.0)) throw DesignError(fmt::format("Q is {}, expected a value above 0", q));
  if (order < 1 || order > 12)
    throw DesignError(fmt::format("{} RC pairs were asked for, expected 1 to 12", order));
  if (!(band.from.value > 0.0) || !(band.to > band.from))
    throw DesignError("the band is empty, expected 0 < from < to");
  FractionalElement out;
  out.alpha = alpha;
  out.q = q;
  out.form = form;
  out.band = band;
  const Rational z = oustaloup(alpha, q, band, order);
  out.parts = Builder(z, form).parts();
  for (FractionalElement::Part& part : out.parts) {
    if (!(part.wanted > 0.0) || !std::isfinite(part.wanted)) {
      throw DesignError(fmt::format(
          "{} comes out as {}: the continued fraction is ill-conditioned, expected a lower order or a "
          "Foster form",
          part.name, part.wanted));
    }
    part.realised = (part.resistor ? resistors : capacitors).nearest(part.wanted);
  }
  return out;
}

}  // namespace bodesmith
