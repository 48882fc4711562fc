#include "approximate/log_symmetric.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "numeric/elliptic_k.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

/// Where the two means have met, relative: a few roundings.
constexpr long double kMeansMeet = 1e-19L;

/// exp(z), by the real function on the real axis.
std::complex<long double> exponential(std::complex<long double> z) {
  return z.imag() == 0.0L ? std::exp(z.real()) : std::exp(z);
}

/// An eigenvalue of Jacobi's matrix to the last digits: Newton's steps on its polynomial,
///   p_(k+1)(x) = (x - a_k) p_k(x) - b_k p_(k-1)(x), a_0 = beta, a_k = 0, b_k the products next to the diagonal.
std::complex<long double> polished(std::complex<long double> x, long double beta,
                                   const std::vector<long double>& products) {
  for (int step = 0; step < 3; ++step) {
    std::complex<long double> before = 1.0L, p = x - beta, slope_before = 0.0L, slope = 1.0L;
    for (const long double product : products) {
      slope_before = std::exchange(slope, p + x * slope - product * slope_before);
      before = std::exchange(p, x * p - product * before);
    }
    if (slope == 0.0L) break;  // a double root: as good as it gets
    x -= p / slope;
  }
  return x;
}

}  // namespace

EllipticFunctions jacobi_elliptic(long double argument, long double complementary_modulus) {
  // am(u) by the arithmetic-geometric mean: phi_N = 2^N a_N u, sin(2 phi_(n-1) - phi_n) = (c_n/a_n) sin phi_n
  // (Abramowitz and Stegun, 16.4).
  std::array<long double, 32> a{};
  std::array<long double, 32> c{};
  long double b = complementary_modulus;
  a[0] = 1.0L;
  std::size_t n = 0;
  while (n + 1 < a.size() && std::abs(a[n] - b) > kMeansMeet * a[n]) {
    c[n + 1] = 0.5L * (a[n] - b);
    a[n + 1] = 0.5L * (a[n] + b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  long double phi = std::ldexp(a[n] * argument, static_cast<int>(n));
  for (std::size_t i = n; i > 0; --i) phi = 0.5L * (phi + std::asin(c[i] / a[i] * std::sin(phi)));
  const long double sn = std::sin(phi);
  const long double cn = std::cos(phi);
  return {sn, cn, std::sqrt(cn * cn + complementary_modulus * complementary_modulus * sn * sn)};
}

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

NormalisedApproximation from_log_positions(const std::vector<std::complex<long double>>& zeta,
                                           long double log_kappa, long double beta) {
  NormalisedApproximation out;
  long double log_gain = 0.5L * beta * log_kappa;
  for (const std::complex<long double>& z : zeta) {
    out.zeros.push_back(static_cast<std::complex<double>>(-exponential(-0.5L * z)));
    out.poles.push_back(static_cast<std::complex<double>>(-exponential(0.5L * z)));
    log_gain += 0.5L * z.real();
  }
  out.gain = static_cast<double>(std::exp(log_gain));
  return out;
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
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(order, order);
  jacobi(0, 0) = static_cast<double>(beta);
  std::vector<long double> products;
  for (int k = 1; k < order; ++k) {
    products.push_back((k - beta) * (k + beta) / ((2.0L * k - 1.0L) * (2.0L * k + 1.0L)));
    const auto product = static_cast<double>(products.back());
    const double root = std::sqrt(std::abs(product));
    jacobi(k, k - 1) = root;
    jacobi(k - 1, k) = product < 0.0 ? -root : root;
  }
  const long double m = std::tanh(0.25L * log_kappa);
  std::vector<std::complex<long double>> zeta;
  for (const std::complex<double> root : eigenvalues(jacobi))
    zeta.push_back(4.0L * std::atanh(m * polished(root, beta, products)));
  return zeta;
}

std::vector<long double> pade_positions(long double log_kappa, long double beta, int order) {
  std::vector<long double> zeta;
  for (const auto& z : pade_positions_complex(log_kappa, beta, order)) zeta.push_back(z.real());
  std::ranges::sort(zeta, std::greater<>());
  return zeta;
}

}  // namespace bodesmith
