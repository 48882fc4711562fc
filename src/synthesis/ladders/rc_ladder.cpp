#include "synthesis/ladders/rc_ladder.hpp"

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <utility>

namespace bodesmith::synthesis {

std::complex<double> RcImpedance::operator()(std::complex<double> s) const {
  std::complex<double> out = high;
  for (std::size_t i = 0; i < poles.size(); ++i) out *= (s + zeros[i]) / (s + poles[i]);
  return out;
}

namespace ladder_synthesis {

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

void Drawing::resistor(const std::string& from, const std::string& to, Real value) {
  parts_.push_back({true, fmt::format("R{}", ++resistors_), from, to, static_cast<double>(value)});
}

void Drawing::capacitor(const std::string& from, const std::string& to, Real value) {
  parts_.push_back({false, fmt::format("C{}", ++capacitors_), from, to, static_cast<double>(value)});
}

std::vector<double> natural_frequencies(const Matrix& a, const Matrix& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(a, b, Eigen::EigenvaluesOnly);
  std::vector<double> out;
  for (const Real value : solver.eigenvalues()) out.push_back(static_cast<double>(value));
  return out;
}

}  // namespace ladder_synthesis
}  // namespace bodesmith::synthesis
