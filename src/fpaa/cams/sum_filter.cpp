#include "fpaa/cams/sum_filter.hpp"

#include "fpaa/cams/cam_type.hpp"

namespace bodesmith::fpaa {

const CamType& sum_filter_type() {
  static const CamType type = [] {
    CamType t;
    t.name = "SumFilter";
    t.parameters = {"corner_hz", "gain_1", "gain_2"};
    t.resources = Resources{.opamps = 1, .capacitors = 4, .comparators = 0, .sars = 0, .lookup_tables = 0};
    t.transfer = "-(C1 V1 + C2 V2)/(Cout + Cint(1 - 1/z))";
    t.transfer_ground = Ground::assumed;
    t.limits = "corner as the FilterBilinear low pass";
    return t;
  }();
  return type;
}

}  // namespace bodesmith::fpaa
