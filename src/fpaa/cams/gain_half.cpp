#include "fpaa/cams/gain_half.hpp"

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& gain_half_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "GainHalf";
    t.options = {"Inverting", "Non-inverting"};
    t.parameters = {"gain"};
    t.resources = Resources{.opamps = 1, .capacitors = 2, .comparators = 0, .sars = 0, .lookup_tables = 0};
    t.transfer = "-+Cin/Cout, output returns to ground in the other half cycle";
    t.transfer_ground = Ground::derived;
    t.half_cycle_output = true;
    t.limits = "(1 + gain) fc <= 19.68 MHz; non-inverting: half a cycle late";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
