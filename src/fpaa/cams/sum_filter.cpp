#include "fpaa/cams/sum_filter.hpp"

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& sum_filter_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "SumFilter";
    f.parameters = {{"corner_hz"}, {"gain_1"}, {"gain_2"}};
    f.resources = Resources{.opamps = 1, .capacitors = 4};
    f.transfer = "-(C1 V1 + C2 V2)/(Cout + Cint(1 - 1/z))";
    f.transfer_ground = Ground::assumed;
    f.limits = "corner as the FilterBilinear low pass";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
