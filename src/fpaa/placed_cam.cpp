#include "fpaa/placed_cam.hpp"

#include "fpaa/cams/cam.hpp"

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

std::string_view PlacedCam::cam_name() const {
  return cam->name();
}

std::complex<double> PlacedCam::response(RadPerSecond w, bool with_delays) const {
  std::complex<double> h = z.response(w, clock_a);
  if (with_delays) {
    h *= cycle_delay(w, clock_a, delay_cycles);
    if (output_hold) h *= zero_order_hold(w, clock_a);
  }
  return h;
}

}  // namespace bodesmith::fpaa
