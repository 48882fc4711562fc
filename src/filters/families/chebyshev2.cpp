#include <cmath>

#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

/// |H(jw)|^2 = 1/(1 + 1/(d^2 T_N(1/w)^2)), d^2 = 1/(10^(stop/10) - 1): poles are the reciprocals of Chebyshev poles,
/// zeros those of the polynomial's own.
class Chebyshev2 final : public Family {
 public:
  std::string_view name() const override { return "chebyshev2"; }
  std::string_view what() const override { return "equal ripple in the stop band; corner = its edge"; }
  Corner corner() const override { return Corner::stop_edge; }
  bool has_stop() const override { return true; }
  Prototype prototype(const PrototypeTask& task) const override {
    const double d = std::sqrt(std::expm1(task.stop_db * std::log(10.0) / 10.0));
    const double mu = std::asinh(d) / task.order;
    Prototype out;
    for (const std::complex<double>& point : upper_unit_points(task.order)) {
      const std::complex<double> pole(-std::sinh(mu) * point.imag(), std::cosh(mu) * point.real());
      add_pair(out.poles, 1.0 / pole);
      add_pair(out.zeros, {0.0, 1.0 / point.real()});
    }
    if (task.order % 2 != 0) out.poles.emplace_back(-1.0 / std::sinh(mu), 0.0);
    out.gain = product_of_negatives(out.poles) / product_of_negatives(out.zeros);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Family, chebyshev2_family, Chebyshev2)

}  // namespace bodesmith::filters
