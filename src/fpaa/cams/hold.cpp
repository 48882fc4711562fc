#include "fpaa/cams/hold.hpp"

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& hold_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "Hold";
    t.resources = Resources{.opamps = 1, .capacitors = 2, .comparators = 0, .sars = 0, .lookup_tables = 0};
    t.transfer = "1/z";
    t.transfer_ground = Ground::seen;
    t.delay_cycles = 1.0;
    t.limits = "two in series need opposite phases";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
