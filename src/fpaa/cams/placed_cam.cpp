#include "fpaa/cams/placed_cam.hpp"

namespace bodesmith::fpaa {

CapacitorUnits::CapacitorUnits(std::span<const Capacitor> capacitors) : capacitors_(capacitors) {
  for (const Capacitor& c : capacitors) units_.push_back(c.units);
}

double CapacitorUnits::operator[](std::string_view name) const {
  for (std::size_t i = 0; i < capacitors_.size(); ++i) {
    if (capacitors_[i].name == name) return units_[i];
  }
  return 0.0;
}

void CapacitorUnits::set(std::string_view name, double units) {
  for (std::size_t i = 0; i < capacitors_.size(); ++i) {
    if (capacitors_[i].name == name) units_[i] = units;
  }
}

ZTransfer PlacedCam::z_from(std::size_t input) const {
  if (input == 1) return z;
  return {more_numerators.at(input - 2), z.denominator};
}

int PlacedCam::units_of(std::string_view capacitor) const {
  for (const Capacitor& c : capacitors) {
    if (c.name == capacitor) return c.units;
  }
  return 0;
}

}  // namespace bodesmith::fpaa
