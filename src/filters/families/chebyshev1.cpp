#include <cmath>

#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

/// |H(jw)|^2 = 1/(1 + eps^2 T_N(w)^2), eps^2 = 10^(ripple/10) - 1; poles -sinh(mu + j theta), mu = asinh(1/eps)/N.
class Chebyshev1 final : public Family {
 public:
  std::string_view name() const override { return "chebyshev1"; }
  std::string_view what() const override { return "equal ripple in the pass band; corner = its edge"; }
  Corner corner() const override { return Corner::ripple_edge; }
  bool has_ripple() const override { return true; }
  Prototype prototype(const PrototypeTask& task) const override {
    const double epsilon = std::sqrt(std::expm1(task.ripple_db * std::log(10.0) / 10.0));
    const double mu = std::asinh(1.0 / epsilon) / task.order;
    std::vector<std::complex<double>> poles;
    for (const std::complex<double>& point : upper_unit_points(task.order)) {
      add_pair(poles, {-std::sinh(mu) * point.imag(), std::cosh(mu) * point.real()});
    }
    if (task.order % 2 != 0) poles.emplace_back(-std::sinh(mu), 0.0);
    Prototype out = all_pole(std::move(poles));
    if (task.order % 2 == 0) out.gain /= std::hypot(1.0, epsilon);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Family, chebyshev1_family, Chebyshev1)

}  // namespace bodesmith::filters
