#include "filters/prototype_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith::filters {
namespace {

PolynomialValue reverse_bessel(int order, LongComplex s) {
  LongComplex before = 1.0L;
  LongComplex now = s + 1.0L;
  for (int n = 2; n <= order; ++n) {
    const LongComplex next = static_cast<long double>(2 * n - 1) * now + s * s * before;
    before = now;
    now = next;
  }
  return {now, now - s * before};  // theta_n' = theta_n - s theta_(n-1)
}

/// |H|^2 of an all-pole filter of gain 1 at 0, in long double.
long double all_pole_power(const std::vector<std::complex<double>>& poles, long double w) {
  long double power = 1.0L;
  for (const std::complex<double>& p : poles)
    power *= std::norm(LongComplex(p)) / std::norm(LongComplex(0.0L, w) - LongComplex(p));
  return power;
}

}  // namespace

std::vector<std::complex<double>> bessel_poles(int order) {
  return conjugate_roots(order, 0.7L * static_cast<long double>(order) + 0.3L,
                         [order](LongComplex s) { return reverse_bessel(order, s); });
}

std::vector<std::complex<double>> upper_unit_points(int order) {
  std::vector<std::complex<double>> out;
  for (int i = 0; i < order / 2; ++i) {
    const double angle = std::numbers::pi * (2 * i + 1) / (2.0 * order);
    out.emplace_back(std::cos(angle), std::sin(angle));
  }
  return out;
}

void add_pair(std::vector<std::complex<double>>& roots, std::complex<double> root) {
  roots.push_back(root);
  roots.push_back(std::conj(root));
}

double product_of_negatives(const std::vector<std::complex<double>>& roots) {
  std::complex<double> product = 1.0;
  for (const std::complex<double>& root : roots) product *= -root;
  return product.real();
}

Prototype all_pole(std::vector<std::complex<double>> poles) {
  Prototype out;
  out.gain = product_of_negatives(poles);
  out.poles = std::move(poles);
  return out;
}

Prototype half_power_at_one(std::vector<std::complex<double>> poles) {
  // These families fall monotonically.
  long double low = 0.0L;
  long double high = 1.0L;
  while (all_pole_power(poles, high) > 0.5L) high *= 2.0L;
  for (int i = 0; i < 80; ++i) {
    const long double middle = 0.5L * (low + high);
    (all_pole_power(poles, middle) > 0.5L ? low : high) = middle;
  }
  for (std::complex<double>& p : poles) p /= static_cast<double>(0.5L * (low + high));
  return all_pole(std::move(poles));
}

std::vector<std::complex<double>> conjugate_roots(
    int degree, long double radius, const std::function<PolynomialValue(LongComplex)>& polynomial) {
  std::vector<LongComplex> roots;
  for (int i = 0; i < degree; ++i) {
    const long double angle =
        2.0L * std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.35L) / degree;
    roots.push_back(std::polar(radius, angle));
  }
  for (int round = 0; round < 200; ++round) {
    long double moved = 0.0L;
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const PolynomialValue p = polynomial(roots[i]);
      const LongComplex newton = p.value / p.derivative;
      LongComplex repulsion = 0.0L;
      for (std::size_t j = 0; j < roots.size(); ++j) {
        if (j != i) repulsion += 1.0L / (roots[i] - roots[j]);
      }
      const LongComplex step = newton / (1.0L - newton * repulsion);
      roots[i] -= step;
      moved = std::max(moved, std::abs(step) / std::abs(roots[i]));
    }
    if (moved < 1e-18L) break;
  }
  std::vector<std::complex<double>> out;
  const long double real = 1e-9L;
  for (const LongComplex& r : roots) {
    if (r.imag() > real * std::abs(r)) add_pair(out, std::complex<double>(r));
  }
  for (const LongComplex& r : roots) {
    if (std::abs(r.imag()) <= real * std::abs(r)) out.emplace_back(static_cast<double>(r.real()), 0.0);
  }
  return out;
}

}  // namespace bodesmith::filters
