#include "filters/landen.hpp"

#include <cmath>
#include <numbers>

#include "numeric/elliptic_k.hpp"

namespace bodesmith::filters {

double nome(const Modulus& modulus) {
  return static_cast<double>(std::exp(-std::numbers::pi_v<long double> * complete_elliptic_k(modulus.k) /
                                      complete_elliptic_k(modulus.complement)));
}

Modulus modulus_of_nome(double q) {
  // k = (theta_2/theta_3)^2, k' = (theta_4/theta_3)^2 at argument 0.
  double two = 1.0;
  double three = 1.0;
  double four = 1.0;
  for (int m = 1; m < 200; ++m) {
    const double square = std::pow(q, static_cast<double>(m) * m);
    two += std::pow(q, static_cast<double>(m) * (m + 1));
    three += 2.0 * square;
    four += (m % 2 == 0 ? 2.0 : -2.0) * square;
    if (square < 1e-18) break;
  }
  return {4.0 * std::sqrt(q) * (two / three) * (two / three), (four / three) * (four / three)};
}

LandenSequence::LandenSequence(const Modulus& modulus) : first_(modulus.k) {
  Modulus now = modulus;
  while (now.k > 1e-18 && k_.size() < 40) {
    const double ratio = now.k / (1.0 + now.complement);
    now = {ratio * ratio, 2.0 * std::sqrt(now.complement) / (1.0 + now.complement)};
    k_.push_back(now.k);
  }
}

std::complex<double> LandenSequence::ascend(std::complex<double> w) const {
  for (auto k = k_.rbegin(); k != k_.rend(); ++k) w = (1.0 + *k) * w / (1.0 + *k * w * w);
  return w;
}

std::complex<double> LandenSequence::cd(std::complex<double> u) const {
  return ascend(std::cos(0.5 * std::numbers::pi * u));
}

std::complex<double> LandenSequence::sn(std::complex<double> u) const {
  return ascend(std::sin(0.5 * std::numbers::pi * u));
}

double LandenSequence::inverse_sn_imaginary(double x) const {
  double before = first_;
  for (const double k : k_) {
    x = 2.0 * x / ((1.0 + k) * (1.0 + std::hypot(1.0, x * before)));
    before = k;
  }
  return 2.0 / std::numbers::pi * std::asinh(x);
}

}  // namespace bodesmith::filters
