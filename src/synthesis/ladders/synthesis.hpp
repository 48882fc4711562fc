#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "synthesis/ladders/rc_ladder.hpp"

/// What the four ladder forms are made with; for their files only.
namespace bodesmith::circuit::ladder_synthesis {

using Real = long double;
using Polynomial = std::vector<Real>;  // rising powers
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

/// An impedance with its frequencies in units of `centre`, so that polynomials stay in range.
struct Scaled {
  std::vector<Real> poles, zeros;
  Real high = 0.0L;
  Real centre = 1.0L;
};
Scaled scaled(const RcImpedance& z);

Polynomial from_roots(const std::vector<Real>& roots);

/// Continued fraction of P/Q (equal degrees): constant, coefficient of s, constant, …: first the quotient of
/// the leading coefficients, then by turns.
std::vector<Real> continued_fraction(Polynomial p, Polynomial q);

/// Numbers the parts as they are drawn: R1, R2, …, C1, C2, ….
class Drawing {
 public:
  void resistor(const std::string& from, const std::string& to, Real value);
  void capacitor(const std::string& from, const std::string& to, Real value);
  std::vector<LadderPart> parts() && { return std::move(parts_); }

 private:
  std::vector<LadderPart> parts_;
  int resistors_ = 0, capacitors_ = 0;
};

/// x of A v = x B v, rising; B positive definite.
std::vector<double> natural_frequencies(const Matrix& a, const Matrix& b);

}  // namespace bodesmith::circuit::ladder_synthesis
