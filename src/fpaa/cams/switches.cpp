#include "fpaa/cams/switches.hpp"

#include <algorithm>
#include <utility>

namespace bodesmith::fpaa {

int StageSwitches::inputs() const {
  int out = 0;
  for (const StageCapacitor& c : capacitors) {
    for (const PlateNode& node : {c.near.phase1, c.near.phase2, c.far.phase1, c.far.phase2}) {
      if (node.kind == PlateNode::Kind::input) out = std::max(out, node.number);
    }
  }
  return out;
}

StageSwitches StageSwitches::mirrored() const {
  const auto other = [](int phase) { return phase == 0 ? 0 : 3 - phase; };
  StageSwitches out = *this;
  for (StageCapacitor& c : out.capacitors) {
    c.near = c.near.mirrored();
    c.far = c.far.mirrored();
  }
  for (StageOpAmp& opamp : out.opamps) opamp.reset_phase = other(opamp.reset_phase);
  out.output_phase = other(output_phase);
  return out;
}

StageCapacitor switched_branch(std::string name, double units, PlateNode from, int opamp) {
  return {std::move(name),
          units,
          {from, PlateNode::ground()},
          {PlateNode::virtual_ground(opamp), PlateNode::ground()}};
}

StageCapacitor static_branch(std::string name, double units, PlateNode from, int opamp) {
  return {std::move(name), units, Plate::fixed(from), Plate::fixed(PlateNode::virtual_ground(opamp))};
}

StageCapacitor delayed_branch(std::string name, double units, PlateNode from, int opamp) {
  return {std::move(name),
          units,
          {PlateNode::ground(), from},
          {PlateNode::virtual_ground(opamp), PlateNode::ground()}};
}

StageCapacitor half_period_branch(std::string name, double units, PlateNode from) {
  return {std::move(name), units, {from, PlateNode::ground()}, Plate::fixed(PlateNode::virtual_ground())};
}

}  // namespace bodesmith::fpaa
