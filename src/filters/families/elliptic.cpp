#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "filters/prototype_parts.hpp"
#include "numeric/elliptic_k.hpp"

namespace bodesmith::filters {
namespace {

/// A modulus k of elliptic functions with its complement k' = sqrt(1 - k^2), each to full precision.
struct Modulus {
  double k = 0.0;
  double complement = 1.0;
};

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

/// exp(-pi K'(k)/K(k)).
double nome(const Modulus& modulus) {
  return static_cast<double>(std::exp(-std::numbers::pi_v<long double> * complete_elliptic_k(modulus.k) /
                                      complete_elliptic_k(modulus.complement)));
}

/// The modulus of a nome, by theta functions.
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

/// |H(jw)|^2 = 1/(1 + eps^2 F_N(w)^2), F_N(w) = cd(N u K_1, k_1), w = cd(u K, k): equal ripple in both bands (W. Cauer;
/// S. J. Orfanidis, "Lecture notes on elliptic filter design", 2006, eq. 49 to 67).
class Elliptic final : public Family {
 public:
  std::string_view name() const override { return "elliptic"; }
  std::string_view what() const override {
    return "equal ripple in both bands, the steepest there is; corner = edge of the pass band";
  }
  Corner corner() const override { return Corner::ripple_edge; }
  bool has_ripple() const override { return true; }
  bool has_stop() const override { return true; }
  int highest_order() const override { return 25; }

  Prototype prototype(const PrototypeTask& task) const override {
    const int n = task.order;
    const double epsilon = std::sqrt(std::expm1(task.ripple_db * std::log(10.0) / 10.0));
    const double stop = std::sqrt(std::expm1(task.stop_db * std::log(10.0) / 10.0));
    const double k1 = epsilon / stop;
    const Modulus outer{k1, std::sqrt((1.0 - k1) * (1.0 + k1))};
    const Modulus inner = modulus_of_nome(std::pow(nome(outer), 1.0 / n));  // the degree equation
    const LandenSequence jacobi(inner);
    const double v = LandenSequence(outer).inverse_sn_imaginary(1.0 / epsilon) / n;
    Prototype out;
    for (int i = 1; i <= n / 2; ++i) {
      const double u = (2.0 * i - 1.0) / n;
      add_pair(out.zeros, {0.0, 1.0 / (inner.k * jacobi.cd(u).real())});
      const std::complex<double> j(0.0, 1.0);
      std::complex<double> pole = j * jacobi.cd(u - j * v);
      if (pole.imag() < 0.0) pole = std::conj(pole);
      add_pair(out.poles, pole);
    }
    if (n % 2 != 0) {
      const std::complex<double> j(0.0, 1.0);
      out.poles.emplace_back((j * jacobi.sn(j * v)).real(), 0.0);
    }
    out.gain = product_of_negatives(out.poles) / product_of_negatives(out.zeros);
    if (n % 2 == 0) out.gain /= std::hypot(1.0, epsilon);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Family, elliptic_family, Elliptic)

}  // namespace bodesmith::filters
