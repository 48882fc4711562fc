#include "fpaa/branch.hpp"

#include <cmath>
#include <numbers>

namespace bodesmith::fpaa {

std::complex<double> Branch::imitated(RadPerSecond w) const {
  switch (kind) {
    case Kind::corner:
      return {1.0, w.value / corner.value};
    case Kind::differentiating:
      return {0.0, w.value};
    case Kind::constant:
      break;
  }
  return 1.0;
}

Hertz branch_corner(double c0, double c1, Hertz clock) {
  return {clock.value / std::numbers::pi * std::atan(c0 / (c0 + 2.0 * c1))};
}

double branch_ratio(Hertz corner, Hertz clock) {
  return 0.5 * (1.0 / std::tan(std::numbers::pi * corner.value / clock.value) - 1.0);
}

bool is_reachable(const Branch& branch, Hertz clock, int max_capacitor) {
  if (branch.kind != Branch::Kind::corner) return true;
  if (branch.corner.hz().value >= 0.5 * clock.value) return false;
  const double ratio = branch_ratio(branch.corner.hz(), clock);
  return ratio <= max_capacitor + 0.5 && ratio >= 1.0 / (max_capacitor + 0.5);
}

Band clocks_for_corner(RadPerSecond corner, int max_capacitor) {
  // tan(pi f/fc) = 1/(1 + 2 ratio), ratio between 1/max and max.
  const double max_ratio = max_capacitor + 0.5;
  const double f = corner.hz().value * std::numbers::pi;
  return {{f / std::atan(1.0 / (1.0 + 2.0 / max_ratio))}, {f / std::atan(1.0 / (1.0 + 2.0 * max_ratio))}};
}

}  // namespace bodesmith::fpaa
