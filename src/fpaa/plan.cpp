#include "fpaa/plan.hpp"

namespace bodesmith::fpaa {

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

std::vector<std::string> Plan::signal_path() const {
  std::vector<std::string> out;
  if (!wires.empty()) out.push_back(wires.front().from);
  for (const Wire& wire : wires) out.push_back(wire.to);
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
