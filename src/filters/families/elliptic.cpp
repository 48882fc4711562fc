#include <cmath>

#include "filters/landen.hpp"
#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

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

const Family& elliptic_family() {
  static const Elliptic family;
  return family;
}

}  // namespace bodesmith::filters
