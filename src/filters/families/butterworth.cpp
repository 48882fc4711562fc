#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

/// |H(jw)|^2 = 1/(1 + w^(2N)) (S. Butterworth, "On the theory of filter amplifiers", 1930).
class Butterworth final : public Family {
 public:
  std::string_view name() const override { return "butterworth"; }
  std::string_view what() const override { return "flat as long as possible; corner = -3 dB"; }
  Prototype prototype(const PrototypeTask& task) const override {
    std::vector<std::complex<double>> poles;
    for (const std::complex<double>& point : upper_unit_points(task.order)) {
      add_pair(poles, {-point.imag(), point.real()});
    }
    if (task.order % 2 != 0) poles.emplace_back(-1.0, 0.0);
    Prototype out = all_pole(std::move(poles));
    out.gain = 1.0;
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Family, butterworth_family, Butterworth)

}  // namespace bodesmith::filters
