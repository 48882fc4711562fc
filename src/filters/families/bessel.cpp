#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

/// H(s) = theta_N(0)/theta_N(s), theta_N the reverse Bessel polynomial: the flattest group delay (W. E. Thomson, 1949),
/// scaled to its half-power frequency.
class Bessel final : public Family {
 public:
  std::string_view name() const override { return "bessel"; }
  std::string_view what() const override { return "flat group delay; corner = -3 dB"; }
  int highest_order() const override { return 25; }
  Prototype prototype(const PrototypeTask& task) const override {
    return half_power_at_one(bessel_poles(task.order));
  }
};

}  // namespace

BODESMITH_ENTRY(Family, bessel_family, Bessel)

}  // namespace bodesmith::filters
