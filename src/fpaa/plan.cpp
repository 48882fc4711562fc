#include "fpaa/plan.hpp"

namespace bodesmith::fpaa {

std::complex<double> PlacedCam::response(RadPerSecond w, bool with_delays) const {
  std::complex<double> h = z.response(w, clock_a);
  if (with_delays) {
    h *= cycle_delay(w, clock_a, delay_cycles);
    if (output_hold) h *= zero_order_hold(w, clock_a);
  }
  return h;
}

Resources ChipPlan::resources() const {
  Resources sum;
  for (const PlacedCam& cam : cams) sum += cam.resources;
  return sum;
}

std::vector<const PlacedCam*> Plan::cams() const {
  std::vector<const PlacedCam*> out;
  for (const ChipPlan& chip : chips) {
    for (const PlacedCam& cam : chip.cams) out.push_back(&cam);
  }
  return out;
}

std::complex<double> plan_response(const Plan& plan, RadPerSecond w, bool with_delays) {
  std::complex<double> h = 1.0;
  for (const ChipPlan& chip : plan.chips) {
    for (const PlacedCam& cam : chip.cams) h *= cam.response(w, with_delays);
  }
  return h;
}

}  // namespace bodesmith::fpaa
