#include "fpaa/plan/plan.hpp"

#include <algorithm>

#include "base/text.hpp"

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

std::set<double> Plan::clocks_hz() const {
  std::set<double> out;
  for (const PlacedCam* cam : cams()) out.insert(cam->clock_a.value);
  return out;
}

int Plan::opamps() const {
  int out = 0;
  for (const ChipPlan& chip : chips) out += chip.resources().opamps;
  return out;
}

std::string Plan::input_pin() const {
  for (const Wire& wire : wires)
    if (std::ranges::find(wires, wire.from, &Wire::to) == wires.end() && WireEnd(wire.from).is_input_pin())
      return wire.from;
  return {};
}

std::string Plan::output_pin() const {
  for (const Wire& wire : wires)
    if (std::ranges::find(wires, wire.to, &Wire::from) == wires.end() && WireEnd(wire.to).is_output_pin())
      return wire.to;
  return {};
}

std::vector<std::string> Plan::signal_path() const {
  const std::string output = output_pin();
  std::vector<std::vector<std::string>> ways{{input_pin()}};
  std::set<std::string> reached{ways[0][0]};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    if (ways[i].back() == output) return ways[i];
    for (const Wire& wire : wires) {
      if (wire.from != ways[i].back() || !reached.insert(wire.to).second) continue;
      ways.push_back(ways[i]);
      ways.back().push_back(wire.to);
    }
  }
  return {};
}

WireEnd::WireEnd(const std::string& text) : name(text) {
  const std::size_t dot = text.find('.');
  double number = 0.0;
  if (dot == std::string::npos || text.compare(0, 4, "chip") != 0 ||
      !parse_number(text.substr(4, dot - 4), number))
    return;
  chip = static_cast<int>(number);
  name = text.substr(dot + 1);
}

bool WireEnd::is_numbered(std::string_view kind) const {
  return chip > 0 && name.size() > kind.size() && name.starts_with(kind) &&
         name.find_first_not_of("0123456789", kind.size()) == std::string::npos;
}

const char* to_string(PlanOptions::Topology topology) {
  static constexpr const char* kNames[] = {"auto", "chain", "bilinear"};
  return kNames[static_cast<std::size_t>(topology)];
}

}  // namespace bodesmith::fpaa
