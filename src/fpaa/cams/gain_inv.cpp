#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& gain_inv_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "GainInv";
    t.parameters = {"gain"};
    t.resources = Resources{.opamps = 1, .capacitors = 4, .comparators = 0, .sars = 0, .lookup_tables = 0};
    t.transfer = "-Cin/Cout";
    t.transfer_ground = Ground::derived;
    t.limits = "output valid the full cycle";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
