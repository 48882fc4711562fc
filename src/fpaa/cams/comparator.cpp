#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& comparator_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "Comparator";
    t.options = {"Signal Ground", "Dual Input", "Variable Reference"};
    t.parameters = {"hysteresis_v"};
    t.resources = Resources{.opamps = 0, .capacitors = 0, .comparators = 1, .sars = 0, .lookup_tables = 0};
    t.transfer = "logic: input above reference";
    t.transfer_ground = Ground::seen;
    t.limits = "hysteresis 0 or 0.01 V";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
