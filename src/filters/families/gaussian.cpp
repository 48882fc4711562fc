#include <cmath>

#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

/// |H(jw)|^2 = 1/(1 + z + z^2/2! + … + z^N/N!), z proportional to w^2 (M. Dishal, "Gaussian-response filter design",
/// 1959): a step response without overshoot. Scaled to its half-power frequency.
class Gaussian final : public Family {
 public:
  std::string_view name() const override { return "gaussian"; }
  std::string_view what() const override { return "steps without overshoot; corner = -3 dB"; }
  int highest_order() const override { return 20; }
  Prototype prototype(const PrototypeTask& task) const override {
    const auto exponential = [n = task.order](LongComplex z) {
      // sum z^k/k!, and its derivative, the sum one shorter.
      LongComplex term = 1.0L;
      LongComplex shorter = 0.0L;
      LongComplex sum = 1.0L;
      for (int k = 1; k <= n; ++k) {
        shorter = sum;
        term *= z / static_cast<long double>(k);
        sum += term;
      }
      return PolynomialValue{sum, shorter};
    };
    std::vector<std::complex<double>> poles;
    // z = w^2 = -s^2, of each root the s in the left half plane.
    for (const std::complex<double>& z : conjugate_roots(task.order, 0.6L * task.order + 0.4L, exponential)) {
      if (z.imag() < 0.0) continue;
      const std::complex<double> s = std::sqrt(-z);
      if (z.imag() == 0.0) {
        poles.emplace_back(-s.real(), 0.0);
      } else {
        add_pair(poles, s.real() > 0.0 ? -s : s);
      }
    }
    return half_power_at_one(std::move(poles));
  }
};

}  // namespace

BODESMITH_ENTRY(Family, gaussian_family, Gaussian)

}  // namespace bodesmith::filters
