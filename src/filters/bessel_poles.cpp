#include "filters/bessel_poles.hpp"

#include "filters/prototype_parts.hpp"

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

}  // namespace

std::vector<std::complex<double>> bessel_poles(int order) {
  return conjugate_roots(order, 0.7L * static_cast<long double>(order) + 0.3L,
                         [order](LongComplex s) { return reverse_bessel(order, s); });
}

}  // namespace bodesmith::filters
