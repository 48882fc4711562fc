#include "fpaa/cams/placed_cam.hpp"

#include <algorithm>

namespace bodesmith::fpaa {

CapacitorUnits::CapacitorUnits(std::span<const Capacitor> capacitors) : capacitors_(capacitors) {
  for (const Capacitor& c : capacitors) units_.push_back(c.units);
}

CapacitorUnits::CapacitorUnits(std::span<const Capacitor> capacitors, std::span<const double> units)
    : capacitors_(capacitors), units_(units.begin(), units.end()) {
  constexpr double kLeast = 1e-9;
  for (std::size_t i = 0; i < units_.size(); ++i) {
    if (capacitors[i].units > 0) units_[i] = std::max(units_[i], kLeast);
  }
}

double CapacitorUnits::operator[](std::string_view name) const {
  for (std::size_t i = 0; i < capacitors_.size(); ++i) {
    if (capacitors_[i].name == name) return units_[i];
  }
  return 0.0;
}

}  // namespace bodesmith::fpaa
