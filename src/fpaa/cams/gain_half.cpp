#include "fpaa/cams/gain_half.hpp"

#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

const Cam& gain_half_cam() {
  static const Cam cam([] {
    CamFacts f;
    f.name = "GainHalf";
    f.options = {"Inverting", "Non-inverting"};
    f.parameters = {{"gain"}};
    f.resources = Resources{.opamps = 1, .capacitors = 2};
    f.transfer = "-+Cin/Cout, output returns to ground in the other half cycle";
    f.transfer_ground = Ground::derived;
    f.half_cycle_output = true;
    f.limits = "(1 + gain) fc <= 19.68 MHz; non-inverting: half a cycle late";
    return f;
  }());
  return cam;
}

}  // namespace bodesmith::fpaa
