#include "approximate/log_symmetric.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>

#include "approximate/elliptic.hpp"
#include "numeric/elliptic_k.hpp"

namespace bodesmith {

long double half_lead(long double v, long double z) {
  const long double sign = z < 0.0L ? -1.0L : 1.0L;
  z = std::abs(z);
  if (std::isinf(v)) return 0.5L * sign * z;
  const long double smaller = std::min(v, z);
  if (smaller < 0.5L) return sign * std::atanh(std::tanh(0.5L * v) * std::tanh(0.5L * z));
  return 0.5L * sign * (smaller + std::log1p(std::exp(-(v + z))) - std::log1p(std::exp(-std::abs(v - z))));
}

long double half_lead_slope(long double v, long double z) {
  if (std::isinf(v)) return 0.5L;
  const long double q = std::exp(-2.0L * v);
  return 0.5L * (1.0L - q) / (1.0L + q + std::exp(z - v) + std::exp(-z - v));
}

namespace {

/// A position on the real axis or off it.
template <class Position>
NormalisedApproximation mirrored_roots(const std::vector<Position>& zeta, long double log_kappa,
                                       long double beta) {
  NormalisedApproximation out;
  long double log_gain = 0.5L * beta * log_kappa;
  for (const Position& z : zeta) {
    out.zeros.push_back(static_cast<std::complex<double>>(-std::exp(-0.5L * z)));
    out.poles.push_back(static_cast<std::complex<double>>(-std::exp(0.5L * z)));
    log_gain += 0.5L * std::real(z);
  }
  out.gain = static_cast<double>(std::exp(log_gain));
  return out;
}

}  // namespace

NormalisedApproximation from_log_positions(const std::vector<long double>& zeta, long double log_kappa,
                                           long double beta) {
  return mirrored_roots(zeta, log_kappa, beta);
}
NormalisedApproximation from_log_positions(const std::vector<std::complex<long double>>& zeta,
                                           long double log_kappa, long double beta) {
  return mirrored_roots(zeta, log_kappa, beta);
}

std::vector<long double> elliptic_positions(long double log_kappa, long double beta, int order) {
  const long double m = std::tanh(0.5L * log_kappa);
  const long double complement = 1.0L / std::cosh(0.5L * log_kappa);
  const long double period = complete_elliptic_k(complement);
  std::vector<long double> zeta;
  for (int k = 1; k <= order; ++k) {
    const auto e = jacobi_elliptic(period * (1.0L - (4 * k - 1 - 2.0L * beta) / (2 * order + 1)), complement);
    zeta.push_back(2.0L * std::asinh(m * e.sn / e.dn));
  }
  return zeta;
}

std::vector<std::complex<long double>> pade_positions_complex(long double log_kappa, long double beta,
                                                              int order) {
  // Not the symmetric form: (k - beta)(k + beta) may be negative.
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix jacobi = Matrix::Zero(order, order);
  jacobi(0, 0) = beta;
  for (int k = 1; k < order; ++k) {
    const long double product = (k - beta) * (k + beta) / ((2.0L * k - 1.0L) * (2.0L * k + 1.0L));
    const long double root = std::sqrt(std::abs(product));
    jacobi(k, k - 1) = root;
    jacobi(k - 1, k) = product < 0.0L ? -root : root;
  }
  const Eigen::EigenSolver<Matrix> solver(jacobi, false);
  const long double m = std::tanh(0.25L * log_kappa);
  std::vector<std::complex<long double>> zeta;
  for (int k = 0; k < order; ++k) zeta.push_back(4.0L * std::atanh(m * solver.eigenvalues()(k)));
  return zeta;
}

std::vector<long double> pade_positions(long double log_kappa, long double beta, int order) {
  std::vector<long double> zeta;
  for (const auto& z : pade_positions_complex(log_kappa, beta, order)) zeta.push_back(z.real());
  std::sort(zeta.begin(), zeta.end(), std::greater<>());
  return zeta;
}

}  // namespace bodesmith
