#pragma once

#include <complex>
#include <vector>

namespace bodesmith::filters {

/// A modulus k of elliptic functions with its complement k' = sqrt(1 - k^2), each to full precision.
struct Modulus {
  double k = 0.0;
  double complement = 1.0;
};

/// exp(-pi K'(k)/K(k)).
double nome(const Modulus& modulus);
/// The modulus of a nome, by theta functions.
Modulus modulus_of_nome(double q);

/// The Jacobi functions by descending Landen transformations (S. J. Orfanidis, "Lecture notes on elliptic filter
/// design", 2006, eq. 55 to 61); arguments are in units of the quarter period K(k).
class LandenSequence {
 public:
  explicit LandenSequence(const Modulus& modulus);

  std::complex<double> cd(std::complex<double> u) const;
  std::complex<double> sn(std::complex<double> u) const;
  /// v for which sn(j v) = j x, x >= 0.
  double inverse_sn_imaginary(double x) const;

 private:
  std::complex<double> ascend(std::complex<double> w) const;
  double first_;
  std::vector<double> k_;
};

}  // namespace bodesmith::filters
