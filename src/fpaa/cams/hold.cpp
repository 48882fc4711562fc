#include "fpaa/cams/hold.hpp"

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& hold_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "Hold";
    f.resources = Resources{.opamps = 1, .capacitors = 2};
    f.transfer = "1/z";
    f.transfer_ground = Ground::seen;
    f.delay_cycles = 1.0;
    f.takes_half_cycle_anywhere = true;
    f.limits = "two in series need opposite phases";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
