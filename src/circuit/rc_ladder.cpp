#include "circuit/rc_ladder.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <utility>

namespace bodesmith::circuit {
namespace {

using Real = long double;
using Polynomial = std::vector<Real>;  // rising powers
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

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
  Builder(const Scaled& z, LadderForm form) : z_(z) {
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
  std::vector<LadderPart> parts() && { return std::move(parts_); }

 private:
  void add(bool resistor, const std::string& from, const std::string& to, Real value) {
    int& count = resistor ? resistors_ : capacitors_;
    ++count;
    parts_.push_back(
        {resistor, fmt::format("{}{}", resistor ? "R" : "C", count), from, to, static_cast<double>(value)});
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

  const Scaled& z_;
  std::vector<LadderPart> parts_;
  int resistors_ = 0, capacitors_ = 0;
};

/// x of A v = x B v, rising; B positive definite.
std::vector<double> natural_frequencies(const Matrix& a, const Matrix& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(a, b, Eigen::EigenvaluesOnly);
  std::vector<double> out;
  for (Eigen::Index i = 0; i < solver.eigenvalues().size(); ++i)
    out.push_back(static_cast<double>(solver.eigenvalues()(i)));
  return out;
}

}  // namespace

std::optional<LadderForm> ladder_form_named(std::string_view name) {
  if (name == "foster1") return LadderForm::foster1;
  if (name == "foster2") return LadderForm::foster2;
  if (name == "cauer1") return LadderForm::cauer1;
  if (name == "cauer2") return LadderForm::cauer2;
  return std::nullopt;
}

std::complex<double> RcImpedance::operator()(std::complex<double> s) const {
  std::complex<double> out = high;
  for (size_t i = 0; i < poles.size(); ++i) out *= (s + zeros[i]) / (s + poles[i]);
  return out;
}

std::vector<LadderPart> ladder_parts(const RcImpedance& z, LadderForm form) {
  const Scaled in_units = scaled(z);
  return Builder(in_units, form).parts();
}

std::complex<double> ladder_impedance(LadderForm form, std::span<const double> v, std::complex<double> s) {
  using Complex = std::complex<double>;
  switch (form) {
    case LadderForm::foster1: {
      Complex z = v[0];
      for (size_t i = 1; i < v.size(); i += 2) z += v[i] / (1.0 + s * v[i] * v[i + 1]);
      return z;
    }
    case LadderForm::foster2: {
      Complex y = 1.0 / v[0];
      for (size_t i = 1; i < v.size(); i += 2) y += s * v[i + 1] / (1.0 + s * v[i] * v[i + 1]);
      return 1.0 / y;
    }
    case LadderForm::cauer1: {
      Complex z = v.back();
      for (size_t i = v.size() - 1; i >= 2; i -= 2) z = v[i - 2] + 1.0 / (s * v[i - 1] + 1.0 / z);
      return z;
    }
    case LadderForm::cauer2: {
      Complex z = v.back();
      for (size_t i = v.size() - 1; i >= 2; i -= 2)
        z = 1.0 / (1.0 / v[i - 2] + 1.0 / (1.0 / (s * v[i - 1]) + z));
      return z;
    }
  }
  return 0.0;
}

RcImpedance impedance_of(LadderForm form, std::span<const double> v) {
  const Eigen::Index n = static_cast<Eigen::Index>(v.size() / 2);
  // Foster: v = R0, R1, C1, R2, C2, …; Cauer: R1, C1, R2, C2, …, R(n+1).
  const bool foster = form == LadderForm::foster1 || form == LadderForm::foster2;
  const auto r = [&](Eigen::Index k) -> Real {
    return v[static_cast<size_t>(foster ? (k == 0 ? 0 : 2 * k - 1) : 2 * k)];
  };
  const auto c = [&](Eigen::Index k) -> Real {
    return v[static_cast<size_t>(foster ? 2 * k + 2 : 2 * k + 1)];
  };
  Matrix open = Matrix::Zero(n, n), shorted = Matrix::Zero(n, n), storing = Matrix::Zero(n, n);
  RcImpedance out;
  Real conductance = 0.0L;
  for (Eigen::Index k = 0; k <= n; ++k) conductance += 1.0L / r(k);
  switch (form) {
    case LadderForm::foster1:
      for (Eigen::Index k = 0; k < n; ++k) {
        open(k, k) = 1.0L / r(k + 1);
        storing(k, k) = c(k);
      }
      shorted = open + Matrix::Constant(n, n, 1.0L / r(0));
      out.high = static_cast<double>(r(0));
      break;
    case LadderForm::foster2:
      for (Eigen::Index k = 0; k < n; ++k) {
        shorted(k, k) = 1.0L / r(k + 1);
        storing(k, k) = c(k);
      }
      open = shorted;
      for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index k = 0; k < n; ++k) open(i, k) -= 1.0L / (r(i + 1) * r(k + 1) * conductance);
      }
      out.high = static_cast<double>(1.0L / conductance);
      break;
    case LadderForm::cauer1:
      for (Eigen::Index k = 0; k < n; ++k) {
        storing(k, k) = c(k);
        open(k, k) = 1.0L / r(k + 1) + (k > 0 ? 1.0L / r(k) : 0.0L);
        if (k > 0) open(k, k - 1) = open(k - 1, k) = -1.0L / r(k);
      }
      shorted = open;
      shorted(0, 0) += 1.0L / r(0);
      out.high = static_cast<double>(r(0));
      break;
    case LadderForm::cauer2: {
      // (s R + E) i = 0: E v = x R v.
      Matrix loops = Matrix::Zero(n, n);
      for (Eigen::Index k = 0; k < n; ++k) {
        storing(k, k) = 1.0L / c(k);
        loops(k, k) = r(k) + r(k + 1);
        if (k > 0) loops(k, k - 1) = loops(k - 1, k) = -r(k);
      }
      out.poles = natural_frequencies(storing, loops);
      loops(0, 0) -= r(0);
      out.zeros = natural_frequencies(storing, loops);
      out.high = static_cast<double>(1.0L / conductance);
      return out;
    }
  }
  out.poles = natural_frequencies(open, storing);
  out.zeros = natural_frequencies(shorted, storing);
  return out;
}

}  // namespace bodesmith::circuit
