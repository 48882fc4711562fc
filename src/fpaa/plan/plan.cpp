#include "fpaa/plan/plan.hpp"

#include <algorithm>

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

Hertz Plan::fastest_clock() const {
  Hertz out;
  for (const PlacedCam* cam : cams()) out = std::max(out, cam->clock_a);
  return out;
}

std::vector<std::string> Plan::signal_path() const {
  if (!path.empty()) return path;
  std::vector<std::string> out;
  if (!wires.empty()) out.push_back(wires.front().from);
  for (const Wire& wire : wires) out.push_back(wire.to);
  return out;
}

const char* to_string(PlanOptions::Topology topology) {
  switch (topology) {
    case PlanOptions::Topology::chain:
      return "chain";
    case PlanOptions::Topology::bilinear:
      return "bilinear";
    case PlanOptions::Topology::automatic:
      break;
  }
  return "auto";
}

}  // namespace bodesmith::fpaa
